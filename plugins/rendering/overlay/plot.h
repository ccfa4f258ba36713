// Plots in the corner of a picture: how a number has changed in time.
#pragma once

#include "plugins/rendering/overlay/font.h"
#include "plugins/rendering/overlay/pen.h"
#include "plugins/views/plot_history.h"

namespace weir::rendering {

/// Plots stand side by side along the lower edge, from the left. Zero is on the axis where it is near.
void drawPlot(Pen& pen, Font& font, const Plot& plot, int place);

}  // namespace weir::rendering
