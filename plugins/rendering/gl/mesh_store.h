// Meshes in the graphics memory, with normals that are smooth where the surface is and sharp at its edges.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "framework/geometry/triangle_mesh.h"
#include "plugins/rendering/gl/resources.h"
#include "plugins/views/shown_mesh.h"
#include "plugins/views/view.h"

namespace weir::rendering::gl {

struct MeshVertex {
  Vec3f position, normal;
  Vec3f color{1, 1, 1};  ///< times that of the surface
};

/// Three vertices per triangle. The normal at a corner is the mean of those of the triangles there that are
/// turned less than 40 degrees away, weighted by the angles at the corner (G. Thürmer, C. Wüthrich 1998).
/// Triangles with vertices that are not finite, or without area, are left out. Indices out of range are an
/// InternalError.
std::vector<MeshVertex> withNormals(const TriangleMesh& mesh);

class MeshStore {
 public:
  explicit MeshStore(const Functions& gl) : gl_(gl) {}

  MeshId add(const TriangleMesh& mesh);
  /// With the normals that the mesh brings, which are smooth everywhere.
  void replace(MeshId id, const ShownMesh& mesh);

  /// All of these are an InternalError for a mesh that was never added.
  const Aabb& bounds(MeshId id) const { return entry(id).bounds; }
  void draw(MeshId id) const;

 private:
  struct Entry {
    VertexArray array;
    Buffer buffer;
    GLsizei vertices = 0;
    Aabb bounds;
  };
  const Entry& entry(MeshId id) const;
  void replaceVertices(MeshId id, std::span<const MeshVertex> vertices);

  const Functions& gl_;
  std::map<MeshId, Entry> entries_;
  MeshId next_ = 1;
};

}  // namespace weir::rendering::gl
