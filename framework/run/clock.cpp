#include "framework/run/clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/base/check.h"
#include "framework/base/error.h"

namespace weir {

namespace {

// Quotients such as (1/30) / (1/30) or 4.0 * 30 may miss the whole number that is meant by some rounding
// errors. This is far more than those, and far less than any difference that someone means.
constexpr double kRounding = 1e-9;

double fewestParts(double ratio) {
  return std::max(1.0, std::ceil(ratio * (1 - kRounding)));
}

/// The least number of equal steps that divides `interval` into parts no longer than `longest`.
std::int64_t stepsIn(double interval, double longest) {
  const double ratio = interval / longest;
  if (!(ratio <= Clock::kMaxStepsPerFrame))
    throw sceneError(
        fmt::format("a step of {} s divides a frame of {} s into {:.3g} steps", longest, interval, ratio),
        fmt::format("at most {:.0e} steps in a frame", Clock::kMaxStepsPerFrame),
        "times are in seconds; a larger dt or a higher frame_rate makes fewer steps");
  return static_cast<std::int64_t>(fewestParts(ratio));
}

}  // namespace

double evenStep(double remaining, double longest) {
  WEIR_CHECK(remaining > 0);
  WEIR_CHECK(longest > 0);
  return remaining / fewestParts(remaining / longest);
}

Clock::Clock(double frameRate, double longestDt, double duration)
    : frameRate_(frameRate), duration_(duration) {
  WEIR_CHECK(frameRate > 0);
  WEIR_CHECK(longestDt > 0);
  WEIR_CHECK(duration >= 0);
  const double interval = 1 / frameRate;
  const double exact = duration * frameRate;
  const double nearest = std::round(exact);
  // For very long runs the rounding error of the product itself may be larger.
  const double tolerance = kRounding + exact * 1e-15;
  const bool whole = std::abs(exact - nearest) <= tolerance;
  frames_ = static_cast<std::int64_t>(whole ? nearest : std::floor(exact));
  if (frames_ > 0) {
    steps_ = stepsIn(interval, longestDt);
    dt_ = interval / static_cast<double>(steps_);
  }
  if (!whole) {
    const double rest = duration - frameTime(frames_);
    restSteps_ = stepsIn(rest, longestDt);
    restDt_ = rest / static_cast<double>(restSteps_);
  }
  longestStep_ = totalSteps() > 0 ? std::max(dt_, restDt_) : std::min(longestDt, interval);
}

double Clock::stepTime(std::int64_t frame, std::int64_t step) const {
  return frameTime(frame) + static_cast<double>(step) * dtAfterFrame(frame);
}

double Clock::endAfterFrame(std::int64_t frame) const {
  if (frame < frames_) return frameTime(frame + 1);
  return hasRest() ? duration_ : frameTime(frames_);
}

}  // namespace weir
