// Plots in the corner of a picture: how a number has changed in time.
#pragma once

#include <string>
#include <vector>

#include "plugins/rendering/overlay/font.h"
#include "plugins/rendering/overlay/pen.h"

namespace weir::rendering {

struct PlotPoint {
  double time, value;  ///< s; a value that is not finite leaves a gap
};

struct Plot {
  std::string caption;            ///< "kinetic energy in J"
  std::vector<PlotPoint> points;  ///< in the order of their times
  double lastTime = 0;            ///< where the axis of time ends, s
};

/// Plots stand side by side along the lower edge, from the left. Zero is on the axis where it is near.
void drawPlot(Pen& pen, Font& font, const Plot& plot, int place);

}  // namespace weir::rendering
