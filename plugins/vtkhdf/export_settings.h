// The "export" section of a scene file: what --export writes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/graph/configurable.h"

namespace weir {

class ExportSettings final : public Configurable {
 public:
  Param<std::optional<std::vector<std::string>>> attributes{
      *this,
      "attributes",
      std::nullopt,
      {.doc = "The attributes to write, such as velocity and density; all if it is left out. Positions are "
              "always written."}};
  Param<int> every{*this, "every", 1, {.min = 1, .doc = "Write every n-th frame, starting with frame 0."}};
  Param<std::optional<double>> rate{
      *this,
      "rate",
      std::nullopt,
      {.unit = "1/s",
       .min = 0,
       .aboveMin = true,
       .doc = "Instead of every: the number of frames per simulated second, at times of the run's frames."}};
  Param<float> positionError{
      *this,
      "position_error",
      0.0f,
      {.unit = "m",
       .min = 0,
       .doc =
           "How far each coordinate may be from where it was. Coordinates are then rounded to multiples of "
           "the largest power of two (of a metre) that allows it, and the file is smaller; 0 writes them as "
           "they are, in single precision."}};

  Param<bool> byRank{
      *this,
      "by_rank",
      false,
      {.doc = "On several ranks each one writes a file of its own, in a folder beside the file, which stands "
              "for all of them: nothing is gathered. Otherwise the first one writes all."}};

  void validate() const override;

  /// Whether a frame is written, in a run with that many frames a second.
  bool wants(std::int64_t frame, double frameRate) const;
  /// The multiples that coordinates are rounded to, in m; 0 if they are not.
  float grid() const;
};

/// The multiple of `grid` > 0 that is nearest; x if it is so large that there is none between.
float roundedTo(float grid, float x);

}  // namespace weir
