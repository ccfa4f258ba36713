// compact() for predicates that are costly.
#pragma once

#include <type_traits>
#include <utility>

#include "framework/base/api.h"
#include "framework/compute/parallel.h"

namespace WEIR_API weir {

namespace detail {

template <class Keep>
struct MarkKept {
  Keep keep;
  ArrayView<std::uint8_t> marks;
  WEIR_HD void operator()(std::int64_t i) const { marks[i] = keep(i) ? 1 : 0; }
};

struct IsMarked {
  ArrayView<const std::uint8_t> marks;
  WEIR_HD bool operator()(std::int64_t i) const { return marks[i] != 0; }
};

}  // namespace detail

/// compact(), which asks keep(i) once on every back end. `marks` is scratch memory for `bound` answers.
template <class Backend, class Keep>
void compactOnce(Backend& device, std::string_view name, Count count, const Keep& keep,
                 Array<std::uint8_t>& marks, ArrayView<int> indices, int* kept) {
  if constexpr (std::is_same_v<Backend, CudaDevice>) {
    compact(device, name, count, keep, indices, kept);
  } else {
    parallelFor(device, name, count, detail::MarkKept<Keep>{keep, marks.view()});
    compact(device, "list", count, detail::IsMarked{std::as_const(marks).view()}, indices, kept);
  }
}

}  // namespace weir
