// Triangle meshes, and what is wrong with them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

struct TriangleMesh {
  static constexpr std::string_view kPortType = "TriangleMesh";

  std::vector<Vec3f> vertices;   ///< m
  std::vector<Vec3i> triangles;  ///< indices of vertices, counter-clockwise seen from outside

  bool empty() const { return triangles.empty(); }
  Aabb bounds() const;
  double area() const;  ///< m²
  /// Enclosed volume by the divergence theorem, m³; negative if the mesh is inside out.
  double volume() const;
  void flip();  ///< turns all triangles round
  /// x → scale·x, then rotation, then + position.
  void transform(float scale, const Quatf& rotation, const Vec3f& position);
};

/// What a mesh is like. All counts are 0 for a good closed one.
struct MeshDiagnosis {
  std::int64_t openEdges = 0;          ///< edges of one triangle only
  std::int64_t nonManifoldEdges = 0;   ///< edges of more than two triangles
  std::int64_t inconsistentEdges = 0;  ///< edges whose two triangles are turned differently
  std::int64_t flippedTriangles = 0;   ///< the fewest that must be turned so that all neighbours agree
  std::int64_t degenerateTriangles = 0;
  std::int64_t duplicateTriangles = 0;  ///< with the vertices of another one, turned like it or not
  std::int64_t nonFiniteVertices = 0;
  bool insideOut = false;

  bool closed() const { return openEdges == 0 && nonManifoldEdges == 0; }
  bool good() const {
    return closed() && inconsistentEdges == 0 && degenerateTriangles == 0 && duplicateTriangles == 0 &&
           nonFiniteVertices == 0 && !insideOut;
  }
  /// "12 open edges (holes), 3 degenerate triangles"; empty if good.
  std::string message() const;
};

/// Takes O(n log n). Expects a welded mesh: what files store as separate vertices at one place counts as
/// holes.
MeshDiagnosis diagnose(const TriangleMesh& mesh);

/// Merges vertices closer than `tolerance` times the size of the mesh, drops triangles that have no area
/// then, duplicates, and vertices that no triangle uses or that are not finite (with their triangles).
TriangleMesh cleaned(const TriangleMesh& mesh, float tolerance = 1e-6f);

}  // namespace weir
