#include "plugins/rendering/gl/mesh_store.h"

#include <array>
#include <cmath>

#include "framework/base/check.h"

namespace weir::rendering::gl {
namespace {

constexpr float kCosineOfSharp = 0.766f;  // of 40 degrees

struct Corner {
  std::size_t triangle;
  float angle;
};

float angleBetween(const Vec3f& a, const Vec3f& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

std::array<Vec3f, 3> pointsOf(const TriangleMesh& mesh, const Vec3i& t) {
  const int count = int(mesh.vertices.size());
  for (int k = 0; k < 3; ++k) {
    WEIR_CHECK(t[k] >= 0);
    WEIR_CHECK(t[k] < count);
  }
  return {mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]};
}

/// The unit normal of each triangle; zero for one that cannot be drawn.
std::vector<Vec3f> faceNormals(const TriangleMesh& mesh) {
  std::vector<Vec3f> normals;
  normals.reserve(mesh.triangles.size());
  for (const Vec3i& t : mesh.triangles) {
    const auto [a, b, c] = pointsOf(mesh, t);
    const bool finite = isFinite(a) && isFinite(b) && isFinite(c);
    normals.push_back(finite ? normalized(cross(b - a, c - a)) : Vec3f{});
  }
  return normals;
}

}  // namespace

std::vector<MeshVertex> withNormals(const TriangleMesh& mesh) {
  const std::vector<Vec3f> faces = faceNormals(mesh);
  std::vector<std::vector<Corner>> corners(mesh.vertices.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto points = pointsOf(mesh, mesh.triangles[i]);
    for (int k = 0; k < 3; ++k) {
      const Vec3f& here = points[k];
      corners[mesh.triangles[i][k]].push_back(
          {i, angleBetween(points[(k + 1) % 3] - here, points[(k + 2) % 3] - here)});
    }
  }
  std::vector<MeshVertex> vertices;
  vertices.reserve(3 * faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i] == Vec3f{}) continue;
    for (int k = 0; k < 3; ++k) {
      const int vertex = mesh.triangles[i][k];
      Vec3f sum{};
      for (const Corner& corner : corners[vertex])
        if (dot(faces[corner.triangle], faces[i]) > kCosineOfSharp)
          sum += faces[corner.triangle] * corner.angle;
      const Vec3f normal = normalized(sum);
      vertices.push_back(
          {.position = mesh.vertices[vertex], .normal = normal == Vec3f{} ? faces[i] : normal});
    }
  }
  return vertices;
}

/// Of the vertex buffer that is bound: position at attribute 0, normal at 1, colour at 2.
static void describeMeshVertices(const Functions& gl) {
  const auto offset = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  const std::array places{offsetof(MeshVertex, position), offsetof(MeshVertex, normal),
                          offsetof(MeshVertex, color)};
  for (GLuint i = 0; i < places.size(); ++i) {
    gl.enableVertexAttribArray(i);
    gl.vertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, sizeof(MeshVertex), offset(places[i]));
  }
}

MeshId MeshStore::add(const TriangleMesh& mesh) {
  const MeshId id = next_++;
  Entry added;
  added.array = makeVertexArray(gl_);
  added.buffer = makeBuffer(gl_);
  entries_.emplace(id, std::move(added));
  replaceVertices(id, withNormals(mesh));
  return id;
}

void MeshStore::replace(MeshId id, const ShownMesh& mesh) {
  std::vector<MeshVertex> vertices;
  vertices.reserve(3 * mesh.triangles.size());
  for (const Vec3i& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      vertices.push_back({.position = mesh.vertices[t[k]], .normal = mesh.normals[t[k]]});
      if (!mesh.colors.empty()) vertices.back().color = mesh.colors[t[k]];
    }
  replaceVertices(id, vertices);
}

void MeshStore::replaceVertices(MeshId id, std::span<const MeshVertex> vertices) {
  const auto found = entries_.find(id);
  WEIR_CHECK(found != entries_.end());
  Entry& target = found->second;
  gl_.bindVertexArray(target.array.name());
  upload(target.buffer, GL_ARRAY_BUFFER, std::as_bytes(vertices), GL_STATIC_DRAW);
  describeMeshVertices(gl_);
  target.vertices = GLsizei(vertices.size());
  target.bounds = {};
  for (const MeshVertex& vertex : vertices) target.bounds.extend(vertex.position);
}

void MeshStore::draw(MeshId id) const {
  const Entry& mesh = entry(id);
  gl_.bindVertexArray(mesh.array.name());
  gl_.drawArrays(GL_TRIANGLES, 0, mesh.vertices);
}

const MeshStore::Entry& MeshStore::entry(MeshId id) const {
  const auto found = entries_.find(id);
  WEIR_CHECK(found != entries_.end());
  return found->second;
}

}  // namespace weir::rendering::gl
