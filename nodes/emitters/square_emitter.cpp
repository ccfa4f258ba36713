#include "nodes/emitters/square_emitter.h"

#include <algorithm>
#include <cmath>

namespace weir {

namespace {

double particlesAlong(float size, float spacing) {
  return std::max(1.0, std::round(double(size) / spacing));
}

}  // namespace

double SquareEmitter::layerSize(float spacing) const {
  return particlesAlong(width, spacing) * particlesAlong(height, spacing);
}

Emitter::Layer SquareEmitter::makeLayer(const SetupContext& context, float spacing) const {
  const int columns = static_cast<int>(particlesAlong(width, spacing));
  const int rows = static_cast<int>(particlesAlong(height, spacing));
  std::vector<Vec3f> points;
  points.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      points.push_back({(static_cast<float>(column) - 0.5f * static_cast<float>(columns - 1)) * spacing, 0,
                        (static_cast<float>(row) - 0.5f * static_cast<float>(rows - 1)) * spacing});
  return layersOf(context, points);
}

}  // namespace weir
