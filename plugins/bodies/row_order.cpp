#include "plugins/bodies/row_order.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>

namespace weir {

std::vector<std::size_t> orderByColor(const std::vector<RowBodies>& rows, std::size_t bodies) {
  // A bit for each colour that rows of a body have. Of a body with more rows, the others share the last.
  constexpr int kLast = 63;
  std::vector<std::uint64_t> used(bodies);
  std::vector<int> colours;
  for (const RowBodies& row : rows) {
    const auto of = [&](std::size_t body) { return body == RowBodies::kFixed ? 0 : used[body]; };
    const int colour = std::min(std::countr_one(of(row.a) | of(row.b)), kLast);
    for (const std::size_t body : {row.a, row.b})
      if (body != RowBodies::kFixed) used[body] |= std::uint64_t{1} << colour;
    colours.push_back(colour);
  }
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return colours[a] < colours[b]; });
  return order;
}

}  // namespace weir
