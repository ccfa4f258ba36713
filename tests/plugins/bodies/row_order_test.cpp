// The order of rows in which neighbours share no body.
#include "plugins/bodies/row_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace weir::test {
namespace {

bool share(const RowBodies& one, const RowBodies& two) {
  const auto has = [&](std::size_t body) {
    return body != RowBodies::kFixed && (body == two.a || body == two.b);
  };
  return has(one.a) || has(one.b);
}

/// Of a row of boxes that touch their neighbours at four points, the first one at a wall.
std::vector<RowBodies> chain(std::size_t bodies) {
  std::vector<RowBodies> rows;
  for (std::size_t k = 0; k < bodies; ++k)
    for (int point = 0; point < 4; ++point) rows.push_back({k, k == 0 ? RowBodies::kFixed : k - 1});
  return rows;
}

TEST(RowOrder, HasEachRowOnce) {
  const std::vector<RowBodies> rows = chain(9);
  std::vector<std::size_t> order = orderByColor(rows, 9), all(rows.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, all);
}

TEST(RowOrder, NeighboursShareNoBody) {
  const std::vector<RowBodies> rows = chain(50);
  const std::vector<std::size_t> order = orderByColor(rows, 50);
  int shared = 0;
  for (std::size_t k = 1; k < order.size(); ++k) shared += share(rows[order[k - 1]], rows[order[k]]) ? 1 : 0;
  EXPECT_LT(shared, 10);  // where one colour ends and the next begins
}

/// A body with more rows than there are colours, and what does not move.
TEST(RowOrder, TakesAnyNumberOfRowsOfABody) {
  std::vector<RowBodies> rows(100, RowBodies{0, RowBodies::kFixed});
  rows.resize(200);
  EXPECT_EQ(orderByColor(rows, 1).size(), rows.size());
  EXPECT_TRUE(orderByColor({}, 0).empty());
}

}  // namespace
}  // namespace weir::test
