// Random numbers of one birth, by what is born where and when, so that no thread or order decides.
#pragma once

#include "framework/base/random.h"

namespace weir {

class Draws {
 public:
  /// Of the k-th that a particle with this id makes in this step; −1 is for how many.
  WEIR_HD Draws(std::uint64_t seed, std::int64_t id, std::int64_t step, int k)
      : seed_(mixed(mixed(mixed(seed, id), step), k)) {}

  /// In [0, 1).
  WEIR_HD float next() {
    constexpr float kBelowOne = 1 - 0x1p-24f;
    const auto drawn = static_cast<float>(0.5 * noise(seed_, drawn_++) + 0.5);
    return drawn < kBelowOne ? drawn : kBelowOne;
  }
  WEIR_HD float within(const Vec2f& range) { return range.x + next() * (range.y - range.x); }

 private:
  WEIR_HD static std::uint64_t mixed(std::uint64_t seed, std::int64_t by) {
    return splitMix64(seed, static_cast<std::uint64_t>(by) + 1);
  }

  std::uint64_t seed_, drawn_ = 0;
};

}  // namespace weir
