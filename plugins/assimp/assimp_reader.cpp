#include "plugins/assimp/assimp_reader.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <memory>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir {

namespace {

/// Vertices are numbered by int, and a file may use one mesh in many places.
constexpr std::size_t kMostVertices = 500'000'000;

/// Assimp's readers do not check all that its own triangulation relies on.
void checkFaces(const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh* mesh = scene.mMeshes[m];
    if (mesh == nullptr) throw ioError("mesh " + std::to_string(m) + " of the file is missing");
    for (unsigned f = 0; f < mesh->mNumFaces; ++f) {
      const aiFace& face = mesh->mFaces[f];
      if (face.mNumIndices == 0)
        throw ioError("face " + std::to_string(f) + " of mesh " + std::to_string(m) + " has no corners");
      for (unsigned k = 0; k < face.mNumIndices; ++k)
        if (face.mIndices[k] >= mesh->mNumVertices)
          throw ioError("face " + std::to_string(f) + " of mesh " + std::to_string(m) + " names vertex " +
                        std::to_string(face.mIndices[k]) + " of " + std::to_string(mesh->mNumVertices));
    }
  }
}

class SceneTriangles {
 public:
  explicit SceneTriangles(const aiScene& scene) : scene_(scene) {}

  /// All meshes of the scene, each wherever a node places it.
  TriangleMesh collect() {
    std::vector<std::pair<const aiNode*, aiMatrix4x4>> open;  // a stack, as files may nest nodes deeply
    if (scene_.mRootNode != nullptr) open.emplace_back(scene_.mRootNode, aiMatrix4x4());
    while (!open.empty()) {
      const auto [node, above] = open.back();
      open.pop_back();
      const aiMatrix4x4 transform = above * node->mTransformation;
      for (unsigned i = 0; i < node->mNumMeshes; ++i) {
        if (node->mMeshes[i] >= scene_.mNumMeshes) throw ioError("a node names a mesh that is not there");
        add(*scene_.mMeshes[node->mMeshes[i]], transform);
      }
      for (unsigned i = 0; i < node->mNumChildren; ++i)
        if (node->mChildren[i] != nullptr) open.emplace_back(node->mChildren[i], transform);
    }
    return std::move(result_);
  }

 private:
  void add(const aiMesh& mesh, const aiMatrix4x4& transform) {
    const std::size_t first = result_.vertices.size();
    if (first + mesh.mNumVertices > kMostVertices)
      throw ioError("the file has more than " + std::to_string(kMostVertices) + " vertices");
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D v = transform * mesh.mVertices[i];
      result_.vertices.push_back({v.x, v.y, v.z});
    }
    const bool mirrored = transform.Determinant() < 0;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // a point or a line: larger faces have been triangulated
      Vec3i triangle;
      for (int k = 0; k < 3; ++k) triangle[k] = static_cast<int>(first + face.mIndices[k]);
      if (mirrored) std::swap(triangle.y, triangle.z);
      result_.triangles.push_back(triangle);
    }
  }

  const aiScene& scene_;
  TriangleMesh result_;
};

}  // namespace

std::vector<std::string> AssimpReader::extensions() const {
  std::string list;
  Assimp::Importer().GetExtensionList(list);  // "*.3ds;*.obj;…"
  std::vector<std::string> extensions;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find(';', at), list.size());
    if (end - at > 2) extensions.push_back(list.substr(at + 1, end - at - 1));
    at = end + 1;
  }
  return extensions;
}

TriangleMesh AssimpReader::read(const std::filesystem::path& file) const {
  try {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(file.string(), 0);
    if (scene != nullptr) {
      checkFaces(*scene);
      scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
    }
    if (scene == nullptr)
      throw ioError("the mesh cannot be read: " + printable(importer.GetErrorString(), 300));
    return SceneTriangles(*scene).collect();
  } catch (Error& e) {
    throw e.at({.file = file.string()});
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw ioError("the mesh cannot be read: " + printable(e.what(), 300)).at({.file = file.string()});
  }
}

}  // namespace weir
