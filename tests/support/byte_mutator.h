// Damages files: flipped bits, bytes that are lost, doubled, overwritten or cut off.
#pragma once

#include <algorithm>
#include <string>

#include "tests/support/scene_mutator.h"

namespace weir::test {

/// One to four mistakes in a text that is not empty; the same seed makes the same mistakes.
inline std::string damaged(std::string bytes, std::uint64_t seed) {
  Random random(seed);
  constexpr std::size_t kMaxMistakes = 4, kLongestPiece = 40;
  for (std::size_t left = 1 + random.below(kMaxMistakes); left > 0 && !bytes.empty(); --left) {
    const std::size_t at = random.below(bytes.size());
    const std::size_t size = std::min(1 + random.below(kLongestPiece), bytes.size() - at);
    switch (random.below(6)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(random.below(256));
        break;
      case 2:
        bytes.erase(at, size);
        break;
      case 3:
        bytes.insert(random.below(bytes.size()), bytes.substr(at, size));
        break;
      case 4:
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), size,
                    random.chance(0.5) ? '\xff' : '\0');
        break;
      default:
        bytes.resize(at);
    }
  }
  return bytes;
}

}  // namespace weir::test
