#include "plugins/rendering/overlay/ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace weir::rendering {
namespace {

/// The largest of 1, 2 or 5 times a power of ten that is at most `step`, or the next one if that is nearer.
double roundStep(double step) {
  const double power = std::pow(10.0, std::floor(std::log10(step)));
  const double leading = step / power;
  if (leading < 1.5) return power;
  if (leading < 3.5) return 2 * power;
  return leading < 7.5 ? 5 * power : 10 * power;
}

std::string label(double value, double step, double largest) {
  // Beyond these, plain numbers are longer than a bar is wide.
  constexpr double kLargestPlain = 1e6, kSmallestPlain = 1e-4;
  if (std::abs(value) < 1e-9 * step) value = 0;  // not -0
  if (largest >= kLargestPlain || step < kSmallestPlain) return fmt::format("{:.6g}", value);
  const int decimals = std::max(0, -int(std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

std::vector<Tick> roundTicks(double lowest, double highest, int wanted) {
  if (!std::isfinite(lowest)) return {};
  const double range = highest - lowest;
  const double largest = std::max(std::abs(lowest), std::abs(highest));
  // A range that is lost in the rounding of its ends has no ticks of its own.
  if (!std::isfinite(range) || !(range > 1e-12 * largest)) return {{lowest, fmt::format("{:.4g}", lowest)}};
  const double step = roundStep(range / wanted);
  std::vector<Tick> ticks;
  const double slack = 1e-6 * range;  // ends that are round but for rounding errors
  for (double k = std::ceil((lowest - slack) / step); k * step <= highest + slack; ++k)
    ticks.push_back({k * step, label(k * step, step, largest)});
  return ticks;
}

std::string timeText(double seconds) {
  return fmt::format("t = {:.3f} s", seconds);
}

std::string particleText(std::int64_t count) {
  std::string digits = std::to_string(count);
  for (int place = int(digits.size()) - 3; place > (count < 0 ? 1 : 0); place -= 3)
    digits.insert(std::size_t(place), ",");
  return digits + (count == 1 ? " particle" : " particles");
}

}  // namespace weir::rendering
