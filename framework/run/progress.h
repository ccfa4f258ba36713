// Shows how far a run is: one line that is kept fresh on a terminal, or a line now and then elsewhere.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "framework/base/api.h"
#include "framework/run/simulation.h"

namespace WEIR_API weir {

/// What is shown of a run.
struct ProgressState {
  std::int64_t frame = 0, lastFrame = 0;
  std::int64_t steps = 0;
  double time = 0, endTime = 0;  ///< simulated, s
  double stepSeconds = 0;        ///< that steps took so far, without the observers
  std::int64_t particles = 0;

  static ProgressState of(const Simulation& simulation, std::int64_t lastFrame);
};

class Progress {
 public:
  /// Monotonic time in seconds.
  using WallClock = std::function<double()>;
  using Writer = std::function<void(std::string_view)>;

  /// `width` gives the columns of the terminal, or nothing where the output is not a terminal.
  Progress(Writer write, std::function<std::optional<int>()> width, WallClock now);

  /// To be called after every step and frame. Shows the state if it is time to: ten times a second on a
  /// terminal, otherwise at frame 0, at the last one, and in between after another tenth of all frames or ten
  /// seconds, but not within a second.
  void update(const ProgressState& state);
  /// Clears the line on the terminal, so that something else can be written; the next update shows it again.
  void clearLine();

  /// "frame 57/120 | 1.900 s | 184,233 particles | 12.3 ms/step | 1:05 left"
  std::string text(const ProgressState& state) const;

 private:
  void measure(const ProgressState& state, double now);
  bool isTimeForLine(const ProgressState& state, double now) const;

  Writer write_;
  std::function<std::optional<int>()> width_;
  WallClock now_;

  // Sums that fade, so that their quotients are means over the last while.
  struct Recent {
    double seconds = 0, stepSeconds = 0, steps = 0, simulated = 0;
  };
  Recent recent_;
  std::optional<ProgressState> last_;
  double lastAt_ = 0;
  std::optional<double> shownAt_;
  std::int64_t shownFrame_ = 0;
  bool lineShown_ = false;
};

/// "4:05", "1:02:03", or "2 d 5 h".
std::string durationText(double seconds);
/// "1,234,567".
std::string groupedText(std::int64_t number);

}  // namespace weir
