// What the plots of a run show: numbers of its statistics, frame by frame.
#pragma once

#include <string>
#include <vector>

#include "framework/graph/state.h"
#include "framework/run/simulation.h"
#include "plugins/views/render_settings.h"

namespace weir::rendering {

/// The numbers that the settings name, at the simulation's present frame. Waits for the device if there are
/// any. Throws a scene Error that lists what there is if one is not known; a node's number that is not there
/// yet is NaN.
std::vector<double> plottedNumbers(const GroupList<PlotSettings>& settings, Simulation& simulation);

struct PlotPoint {
  double time, value;  ///< s; a value that is not finite leaves a gap
};

struct Plot {
  std::string caption;            ///< "kinetic energy in J"
  std::vector<PlotPoint> points;  ///< in the order of their times
  double lastTime = 0;            ///< where the axis of time ends, s
};

class PlotHistory {
 public:
  PlotHistory(const GroupList<PlotSettings>& settings, double lastTime);

  void add(double time, const std::vector<double>& numbers);
  const std::vector<Plot>& plots() const { return plots_; }
  void save(const StateWriter& to) const;
  void restore(const StateReader& from);

 private:
  std::vector<Plot> plots_;
};

}  // namespace weir::rendering
