#include "plugins/assimp/assimp_reader.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/isolated_work.h"
#include "framework/base/packed.h"
#include "framework/base/text.h"
#include "framework/geometry/packed_mesh.h"
#include "plugins/assimp/folder_files.h"

namespace weir {

namespace {

constexpr const char* kFormatsVariable = "WEIR_MESH_FORMATS";
constexpr const char* kMemoryVariable = "WEIR_MESH_MEMORY_MB";
constexpr const char* kTimeVariable = "WEIR_MESH_SECONDS";

/// Vertices are numbered by int, and a file may use one mesh in many places.
constexpr std::size_t kMaxVertices = 500'000'000;

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
    if (first + mesh.mNumVertices > kMaxVertices)
      throw ioError("the file has more than " + std::to_string(kMaxVertices) + " vertices");
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

/// What is read unasked: formats that are of use for solids, and whose readers are small.
constexpr std::array<std::string_view, 7> kUsualEndings{".3mf", ".glb", ".gltf", ".obj",
                                                        ".off", ".ply", ".stl"};

bool readsAllFormats() {
  const char* formats = std::getenv(kFormatsVariable);
  return formats != nullptr && std::string_view(formats) == "all";
}

std::vector<std::string> allEndings() {
  std::string list;
  Assimp::Importer().GetExtensionList(list);  // "*.3ds;*.obj;…"
  std::vector<std::string> endings;
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find(';', at), list.size());
    if (end - at > 2) endings.push_back(list.substr(at + 1, end - at - 1));
    at = end + 1;
  }
  return endings;
}

bool contains(const auto& list, std::string_view item) {
  return std::find(list.begin(), list.end(), item) != list.end();
}

/// A positive integer from the environment, in place of a limit's default.
std::uint64_t limitFrom(const char* variable, std::uint64_t usual) {
  constexpr std::uint64_t kMax = 1'000'000'000;
  const char* text = std::getenv(variable);
  if (text == nullptr || *text == 0) return usual;
  const char* end = text + std::strlen(text);
  std::uint64_t number = 0;
  const auto [rest, error] = std::from_chars(text, end, number);
  if (error != std::errc() || rest != end || number == 0 || number > kMax)
    throw usageError(std::string(variable) + " is " + inQuotes(text),
                     "an integer from 1 to " + std::to_string(kMax));
  return number;
}

constexpr std::uint64_t kMegabyte = std::uint64_t{1} << 20;

/// Far more than a good file needs, and little enough for any machine.
ForkedLimits limitsFor(std::uint64_t fileSize) {
  constexpr std::uint64_t kMinMegabytes = 256, kTimesFile = 10;
  constexpr std::uint64_t kMinSeconds = 20, kBytesPerSecond = 1'000'000;
  const std::uint64_t megabytes =
      limitFrom(kMemoryVariable, kMinMegabytes + kTimesFile * fileSize / kMegabyte);
  const std::uint64_t seconds = limitFrom(kTimeVariable, kMinSeconds + fileSize / kBytesPerSecond);
  return {
      .cpuSeconds = static_cast<int>(seconds),
      .seconds = static_cast<int>(3 * std::min<std::uint64_t>(seconds, 100'000'000)),  // disks may be slow
      .memoryBytes = megabytes * kMegabyte,
      .resultBytes = megabytes * kMegabyte,
      .writesFiles = false};
}

TriangleMesh readHere(const std::filesystem::path& file) {
  Assimp::Importer importer;
  importer.SetIOHandler(new FolderFiles(file));  // which the importer owns
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene != nullptr) {
    checkFaces(*scene);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  }
  if (scene == nullptr)
    throw ioError("the mesh cannot be read: " + printable(importer.GetErrorString(), 300));
  return SceneTriangles(*scene).collect();
}

std::string sizeText(std::uint64_t bytes) {
  return std::to_string((bytes + kMegabyte - 1) / kMegabyte) + " MB";
}

/// Where the copy met a limit, what to do about it.
TriangleMesh readInCopy(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  const std::uint64_t bytes = error ? 0 : size;
  const ForkedLimits limits = limitsFor(bytes);
  IsolatedWork copy([&] { return packed(readHere(file)); }, limits, "Assimp");
  try {
    return unpacked(copy.finish());
  } catch (const Error& refusal) {
    if (!copy.metLimit()) throw;
    throw ioError(refusal.message(),
                  "at most " + std::to_string(limits.memoryBytes / kMegabyte) + " MB of memory and " +
                      std::to_string(limits.cpuSeconds) + " s of processor time for a file of " +
                      sizeText(bytes),
                  std::string("where the file is good, ") + kMemoryVariable + " (MB) and " + kTimeVariable +
                      " in the environment set other limits");
  }
}

}  // namespace

std::vector<std::string> AssimpReader::extensions() const {
  std::vector<std::string> endings = allEndings();
  if (!readsAllFormats())
    std::erase_if(endings, [](const std::string& ending) { return !contains(kUsualEndings, ending); });
  return endings;
}

std::string AssimpReader::hintFor(const std::string& extension) const {
  if (readsAllFormats() || !contains(allEndings(), extension)) return {};
  return std::string("Assimp reads such files where ") + kFormatsVariable + "=all is set in the environment";
}

TriangleMesh AssimpReader::read(const std::filesystem::path& file) const {
  try {
    return readInCopy(file);
  } catch (Error& e) {
    throw e.at({.file = file.string()});
  }
}

}  // namespace weir
