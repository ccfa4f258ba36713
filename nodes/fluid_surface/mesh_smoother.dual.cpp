#include "nodes/fluid_surface/mesh_smoother.h"

namespace weir {

namespace {

constexpr float kShare =
    2.0f / 3;  // the shortest waves, which change sign from vertex to vertex, fall to a third

/// Corner c belongs to triangle c/3.
struct VertexOfCorner {
  ArrayView<const Vec3i> triangles;
  WEIR_HD int operator()(std::int64_t corner) const {
    return triangles[corner / 3][static_cast<int>(corner % 3)];
  }
};

/// Values at the vertices towards the mean of those around.
template <class T>
struct Spread {
  ArrayView<const Vec3i> triangles;
  ArrayView<const int> start, corners;
  ArrayView<const T> from;
  ArrayView<T> to;

  WEIR_HD void operator()(std::int64_t i) const {
    const T own = from[i];
    T sum{};
    for (int k = start[i]; k < start[i + 1]; ++k) {
      // In a closed mesh each edge begins here once.
      const int corner = corners[k];
      sum += from[triangles[corner / 3][(corner + 1) % 3]] - own;
    }
    const int around = start[i + 1] - start[i];
    to[i] = around > 0 ? own + (kShare / static_cast<float>(around)) * sum : own;
  }
};

struct FindLoss {
  ArrayView<const Vec3f> vertices, normals, moved;
  ArrayView<float> lost;
  WEIR_HD void operator()(std::int64_t i) const { lost[i] = dot(normals[i], vertices[i] - moved[i]); }
};

struct GiveBack {
  ArrayView<const Vec3f> normals, moved;
  ArrayView<const float> lost;
  ArrayView<Vec3f> vertices;
  WEIR_HD void operator()(std::int64_t i) const { vertices[i] = moved[i] + lost[i] * normals[i]; }
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

template <class Backend, class T>
ArrayView<const T> MeshSmoother::spread(Backend& device, ArrayView<const Vec3i> triangles, int passes,
                                        ArrayView<const T> values, Array<T> (&room)[2]) {
  for (int pass = 0; pass < passes; ++pass) {
    const ArrayView<T> next = room[pass % 2].view();
    parallelFor(device, "surface spread", values.size,
                Spread<T>{triangles, corners_.start(), corners_.order(), values, next});
    values = {next.data, next.size};
  }
  return values;
}

template <class Backend>
void MeshSmoother::smoothOn(Backend& device, DynamicMesh& mesh, int passes) {
  const std::int64_t n = mesh.vertices.size();
  const ArrayView<const Vec3i> triangles = std::as_const(mesh.triangles).view();
  const ArrayView<const Vec3f> vertices = std::as_const(mesh.vertices).view(),
                               normals = std::as_const(mesh.normals).view();
  corners_.sort(device, 3 * triangles.size, static_cast<int>(n), VertexOfCorner{triangles}, kept_.data());
  for (int k = 0; k < 2; ++k) moved_[k].resizeDiscarding(n), lost_[k].resizeDiscarding(n);
  const ArrayView<const Vec3f> moved = spread(device, triangles, passes, vertices, moved_);
  parallelFor(device, "surface loss", n, FindLoss{vertices, normals, moved, lost_[1].view()});
  const ArrayView<const float> lost =
      spread(device, triangles, passes, std::as_const(lost_[1]).view(), lost_);
  parallelFor(device, "surface volume", n, GiveBack{normals, moved, lost, mesh.vertices.view()});
  parallelFor(device, "surface normals", n,
              FaceNormals{triangles, corners_.start(), corners_.order(), vertices, mesh.normals.view()});
}

template void MeshSmoother::smoothOn(ThisBackend&, DynamicMesh&, int);

}  // namespace weir
