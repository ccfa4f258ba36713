// Simulated time: frames at exact times, and equal steps between them, or steps whose length follows the
// motion.
#pragma once

#include <cstdint>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// The first of the least number of equal steps that divide a time of `remaining` into parts no longer than
/// `longest`, both above 0: so a time is met exactly, and no sliver is left for a last step.
double evenStep(double remaining, double longest);

/// Divides simulated time into frames and frames into equal steps. Frame k is at k / frameRate, computed from
/// k each time, so nothing adds up over a long run.
class Clock {
 public:
  /// More steps between two frames are refused: they could not end, and a mistyped unit is likelier.
  static constexpr double kMaxStepsPerFrame = 1e9;

  /// In 1/s, s and s. Rate and step are positive, the duration is not negative. A step is the frame interval
  /// divided by the least whole number that makes it no longer than `longestDt`. Throws a scene Error for
  /// more than kMaxStepsPerFrame.
  Clock(double frameRate, double longestDt, double duration);

  std::int64_t frameCount() const { return frames_; }  ///< frames after frame 0 that lie within the duration
  double frameTime(std::int64_t frame) const { return static_cast<double>(frame) / frameRate_; }

  /// Steps from frame k to frame k + 1. Behind the last frame those of the rest of the duration, which ends
  /// without a frame; 0 if there is no rest.
  std::int64_t stepsAfterFrame(std::int64_t frame) const { return frame < frames_ ? steps_ : restSteps_; }
  double dtAfterFrame(std::int64_t frame) const { return frame < frames_ ? dt_ : restDt_; }
  /// When a step starts.
  double stepTime(std::int64_t frame, std::int64_t step) const;

  /// When the steps after a frame end: at the next frame, or behind the last one at the end of the duration.
  double endAfterFrame(std::int64_t frame) const;

  bool hasRest() const { return restSteps_ > 0; }
  /// The longest step that the run makes; that of a frame if it makes none.
  double longestStep() const { return longestStep_; }
  std::int64_t totalSteps() const { return frames_ * steps_ + restSteps_; }

 private:
  double frameRate_, duration_;
  std::int64_t frames_ = 0, steps_ = 0, restSteps_ = 0;
  double dt_ = 0, restDt_ = 0, longestStep_ = 0;
};

}  // namespace weir
