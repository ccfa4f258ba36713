#include "nodes/fluid_surface/mesh_smoother.h"

namespace weir {

namespace {

constexpr float kShrink = 0.5f, kInflate = -0.53f;

/// Corner c belongs to triangle c/3.
struct VertexOfCorner {
  ArrayView<const Vec3i> triangles;
  WEIR_HD int operator()(std::int64_t corner) const {
    return triangles[corner / 3][static_cast<int>(corner % 3)];
  }
};

struct Move {
  ArrayView<const Vec3i> triangles;
  ArrayView<const int> start, corners;
  float share;
  ArrayView<const Vec3f> from;
  ArrayView<Vec3f> to;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = from[i];
    Vec3f sum;
    for (int k = start[i]; k < start[i + 1]; ++k) {
      // In a closed mesh each edge begins here once.
      const int corner = corners[k];
      sum += from[triangles[corner / 3][(corner + 1) % 3]] - p;
    }
    const int around = start[i + 1] - start[i];
    to[i] = around > 0 ? p + (share / static_cast<float>(around)) * sum : p;
  }
};

struct FaceNormals {
  ArrayView<const Vec3i> triangles;
  ArrayView<const int> start, corners;
  ArrayView<const Vec3f> vertices;
  ArrayView<Vec3f> normals;

  WEIR_HD void operator()(std::int64_t i) const {
    Vec3f sum;
    for (int k = start[i]; k < start[i + 1]; ++k) {
      const Vec3i t = triangles[corners[k] / 3];
      sum += cross(vertices[t.y] - vertices[t.x], vertices[t.z] - vertices[t.x]);
    }
    // Where triangles cancel each other out, what was there is as good as any.
    if (dot(sum, sum) > 0) normals[i] = normalized(sum);
  }
};

}  // namespace

template <class Backend>
void MeshSmoother::smoothOn(Backend& device, DynamicMesh& mesh, int passes) {
  const std::int64_t n = mesh.vertices.size();
  const ArrayView<const Vec3i> triangles = std::as_const(mesh.triangles).view();
  corners_.sort(device, 3 * triangles.size, static_cast<int>(n), VertexOfCorner{triangles}, kept_.data());
  moved_.resizeDiscarding(n);
  for (int pass = 0; pass < passes; ++pass) {
    parallelFor(device, "surface shrink", n,
                Move{triangles, corners_.start(), corners_.order(), kShrink,
                     std::as_const(mesh.vertices).view(), moved_.view()});
    parallelFor(device, "surface inflate", n,
                Move{triangles, corners_.start(), corners_.order(), kInflate, std::as_const(moved_).view(),
                     mesh.vertices.view()});
  }
  parallelFor(device, "surface normals", n,
              FaceNormals{triangles, corners_.start(), corners_.order(), std::as_const(mesh.vertices).view(),
                          mesh.normals.view()});
}

template void MeshSmoother::smoothOn(ThisBackend&, DynamicMesh&, int);

}  // namespace weir
