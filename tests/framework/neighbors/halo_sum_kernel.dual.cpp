#include "tests/framework/neighbors/halo_sum_kernel.h"

#include "framework/neighbors/neighbor_sum.h"

namespace weir::test {

namespace {

struct SumFields {
  NeighborView list;
  float inverseRadius;
  ArrayView<const Vec3f> positions, fields;
  ArrayView<Vec4f> sums;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto s = read(positions, i);
    const auto pair = [&]<class T>(const auto&, const Vec3<T>& p, const Vec3<T>& f) {
      const Vec3<T> d{p.x - s.x, p.y - s.y, p.z - s.z};
      const T t = positivePart(1 - sqrtf(dot(d, d)) * inverseRadius);
      const T w = t * t * t;
      return Vec4<T>{w, w * f.x, w * f.y, w * f.z};
    };
    write(sums, i, sumOverNeighbors<Vec4f>(i, list, pair, positions, fields));
  }
};

}  // namespace

template <class Backend>
void sumFields(Backend& device, Count owned, const NeighborView& list, float radius,
               ArrayView<const Vec3f> positions, ArrayView<const Vec3f> fields, ArrayView<Vec4f> sums) {
  parallelForEights(device, "sum fields", owned, SumFields{list, 1 / radius, positions, fields, sums});
}

template void sumFields(ThisBackend&, Count, const NeighborView&, float, ArrayView<const Vec3f>,
                        ArrayView<const Vec3f>, ArrayView<Vec4f>);

}  // namespace weir::test
