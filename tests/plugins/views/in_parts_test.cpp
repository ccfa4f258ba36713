// Work divided among threads.
#include "plugins/views/in_parts.h"

#include <gtest/gtest.h>

namespace weir::test {
namespace {

TEST(InParts, DoesEachPieceOnce) {
  for (const std::size_t n : {0, 1, 4095, 4096, 8193, 1000003}) {
    std::vector<int> done(n, 0);
    rendering::inParts(n, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++done[i];
    });
    EXPECT_EQ(std::count(done.begin(), done.end(), 1), std::ptrdiff_t(n));
  }
}

}  // namespace
}  // namespace weir::test
