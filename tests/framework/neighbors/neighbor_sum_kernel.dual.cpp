#include "tests/framework/neighbors/neighbor_sum_kernel.h"

#include "framework/neighbors/neighbor_sum.h"

namespace weir::test {

namespace {

struct SumPairs {
  NeighborView list;
  ArrayView<const Vec4f> weighted;
  ArrayView<const Vec3f> positions;
  ArrayView<Vec4f> sums;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto s = read(weighted, i);
    const auto self = asInt(i);
    const auto pair = [&]<class T>(const auto& j, const Vec4<T>& t, const Vec3<T>& p) {
      Vec3<T> d{p.x - s.x, p.y - s.y, p.z - s.z};
      const T r = sqrtf(dot(d, d));
      d.x = select(r == T(0), select(j > self, T(1), T(-1)), d.x);
      return Vec4<T>{d.x * t.w, d.y * t.w, d.z * t.w, r};
    };
    write(sums, i, sumOverNeighbors<Vec4f>(i, list, pair, weighted, positions));
  }
};

}  // namespace

template <class Backend>
void sumPairs(Backend& device, const NeighborView& list, ArrayView<const Vec4f> weighted,
              ArrayView<const Vec3f> positions, ArrayView<Vec4f> sums) {
  parallelForEights(device, "sum pairs", sums.size, SumPairs{list, weighted, positions, sums});
}

template void sumPairs(ThisBackend&, const NeighborView&, ArrayView<const Vec4f>, ArrayView<const Vec3f>,
                       ArrayView<Vec4f>);

}  // namespace weir::test
