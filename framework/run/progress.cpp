#include "framework/run/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace weir {

namespace {

constexpr double kRefreshSeconds = 0.1;   // on a terminal
constexpr double kMinLineSeconds = 1;     // between lines elsewhere
constexpr double kMaxLineSeconds = 10;    // without a line elsewhere
constexpr double kSmoothingSeconds = 10;  // how long the speed is remembered
constexpr double kLineShare = 0.1;        // of all frames, for another line

}  // namespace

ProgressState ProgressState::of(const Simulation& simulation, std::int64_t lastFrame) {
  const Clock& clock = simulation.clock();
  const bool whole = lastFrame == clock.frameCount();
  return {.frame = simulation.frame(),
          .lastFrame = lastFrame,
          .steps = simulation.stepsDone(),
          .time = simulation.time(),
          .endTime = whole ? clock.endAfterFrame(lastFrame) : clock.frameTime(lastFrame),
          .stepSeconds = simulation.stepSeconds(),
          .particles = simulation.particleCount()};
}

Progress::Progress(Writer write, std::function<std::optional<int>()> width, WallClock now)
    : write_(std::move(write)), width_(std::move(width)), now_(std::move(now)) {}

void Progress::measure(const ProgressState& state, double now) {
  if (last_) {
    const double elapsed = now - lastAt_;
    const double keep = std::exp(-elapsed / kSmoothingSeconds);
    recent_.seconds = recent_.seconds * keep + elapsed;
    recent_.stepSeconds = recent_.stepSeconds * keep + state.stepSeconds - last_->stepSeconds;
    recent_.steps = recent_.steps * keep + static_cast<double>(state.steps - last_->steps);
    recent_.simulated = recent_.simulated * keep + state.time - last_->time;
  }
  last_ = state;
  lastAt_ = now;
}

bool Progress::isTimeForLine(const ProgressState& state, double now) const {
  if (!shownAt_ || state.frame == state.lastFrame) return true;
  const double since = now - *shownAt_;
  const auto frames = static_cast<double>(state.frame - shownFrame_);
  return since >= kMaxLineSeconds ||
         (since >= kMinLineSeconds && frames >= kLineShare * static_cast<double>(state.lastFrame));
}

void Progress::update(const ProgressState& state) {
  const double now = now_();
  measure(state, now);
  const std::optional<int> width = width_();
  if (width) {
    if (shownAt_ && now - *shownAt_ < kRefreshSeconds && state.frame != state.lastFrame) return;
    // One column stays free, because some terminals break the line when the last one is written.
    const auto room = static_cast<std::size_t>(std::max(*width - 1, 1));
    constexpr const char* kClearToEnd = "\x1b[K";
    write_("\r" + text(state).substr(0, room) + kClearToEnd);
    lineShown_ = true;
  } else {
    if (!isTimeForLine(state, now)) return;
    write_(text(state) + "\n");
  }
  shownAt_ = now;
  shownFrame_ = state.frame;
}

void Progress::clearLine() {
  if (!lineShown_) return;
  write_("\r\x1b[K");
  lineShown_ = false;
  shownAt_.reset();
}

std::string Progress::text(const ProgressState& state) const {
  std::string text = fmt::format("frame {}/{} | {:.3f} s | {} particles", state.frame, state.lastFrame,
                                 state.time, groupedText(state.particles));
  if (recent_.steps > 0) {
    constexpr double kMsPerSecond = 1000;
    text += fmt::format(" | {:.1f} ms/step", recent_.stepSeconds / recent_.steps * kMsPerSecond);
    const double left = state.endTime - state.time;
    constexpr double kRounding = 1e-9;
    if (left > kRounding * state.endTime && recent_.simulated > 0)
      text += " | " + durationText(recent_.seconds / recent_.simulated * left) + " left";
  }
  return text;
}

std::string durationText(double seconds) {
  constexpr std::int64_t kMinute = 60, kHour = 3600, kDay = 86400;
  constexpr double kLongest = 1e15;
  const auto s = static_cast<std::int64_t>(std::ceil(std::clamp(seconds, 0.0, kLongest)));
  if (s >= kDay) return fmt::format("{} d {} h", s / kDay, s % kDay / kHour);
  if (s >= kHour) return fmt::format("{}:{:02}:{:02}", s / kHour, s % kHour / kMinute, s % kMinute);
  return fmt::format("{}:{:02}", s / kMinute, s % kMinute);
}

std::string groupedText(std::int64_t number) {
  std::string digits = std::to_string(number);
  const std::size_t first = number < 0 ? 1 : 0;
  for (std::size_t i = digits.size(); i > first + 3;) digits.insert(i -= 3, ",");
  return digits;
}

}  // namespace weir
