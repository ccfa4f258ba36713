#include "tests/framework/compute/eight_kernel.h"

namespace weir::test {
namespace {

struct ChangeNumbers {
  Numbers numbers;
  int* calls;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    using T = NumberAt<Index>;
    const T one = read(numbers.one, i);
    const Vec3<T> three = read(numbers.three, i);
    const Vec4<T> four = read(numbers.four, i);
    write(numbers.one, i, fastSqrt(one) + three.y);
    write(numbers.three, i, {three.x / one, positivePart(three.y) / one, three.z / one});
    write(numbers.four, i, {four.w, four.z, four.y, four.x});
    forEachOf(i, [&](std::int64_t k) {
      if (k % 2 == 1) numbers.four[k].w += 1;
      atomicAdd(calls, 1);
    });
  }
};

}  // namespace

template <class Backend>
void changeNumbers(Backend& device, Count count, const Numbers& numbers, int* calls) {
  parallelForEights(device, "change", count, ChangeNumbers{numbers, calls});
}

template void changeNumbers(ThisBackend&, Count, const Numbers&, int*);

}  // namespace weir::test
