// Round numbers for the scale of a colour bar, and how numbers are written in pictures.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace weir::rendering {

struct Tick {
  double value;
  std::string label;
};

/// Multiples of 1, 2 or 5 times a power of ten within [lowest, highest], about `wanted` of them (2 to
/// 2·wanted), with no more decimals than they need. An empty or infinite range gives one tick at `lowest`, or
/// none if that is not finite.
std::vector<Tick> roundTicks(double lowest, double highest, int wanted);

/// "t = 1.233 s"
std::string timeText(double seconds);

/// "28,934 particles", "1 particle"
std::string particleText(std::int64_t count);

}  // namespace weir::rendering
