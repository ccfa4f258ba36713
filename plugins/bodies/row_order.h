// An order of rows in which neighbours share no body: a processor works on several at a time, as none waits
// for what the one before it changes.
#pragma once

#include <cstddef>
#include <vector>

namespace weir {

/// Of a row; `kStill` is what does not move, which any number of rows may share.
struct RowBodies {
  static constexpr std::size_t kFixed = std::size_t(-1);
  std::size_t a = kFixed, b = kFixed;
};

/// Colours rows greedily, and returns their numbers by colour: 0 to n - 1, each once.
std::vector<std::size_t> orderByColor(const std::vector<RowBodies>& rows, std::size_t bodies);

}  // namespace weir
