// A dynamic mesh on its way to the host, for observers that draw or write it beside the simulation.
#pragma once

#include <span>

#include "framework/base/api.h"
#include "framework/compute/host_copy.h"
#include "framework/geometry/dynamic_mesh.h"

namespace WEIR_API weir {

/// A mesh in host memory that belongs to somebody else; as in DynamicMesh.
struct MeshSpan {
  std::span<const Vec3f> vertices, normals;
  std::span<const Vec3i> triangles;
};

class DynamicMeshCopy {
 public:
  explicit DynamicMeshCopy(Device& device) : vertices_(device), normals_(device), triangles_(device) {}

  /// Asks for the mesh as it is now.
  void start(const DynamicMesh& mesh) {
    copy(mesh.vertices, vertices_);
    copy(mesh.normals, normals_);
    copy(mesh.triangles, triangles_);
  }
  /// Waits until it has arrived; it is there until the next start().
  MeshSpan wait() { return {vertices_.wait(), normals_.wait(), triangles_.wait()}; }

 private:
  template <class T>
  static void copy(const Array<T>& from, HostCopy<T>& to) {
    to.resize(from.size());
    to.start(0, from.data(), from.size());
  }

  HostCopy<Vec3f> vertices_, normals_;
  HostCopy<Vec3i> triangles_;
};

}  // namespace weir
