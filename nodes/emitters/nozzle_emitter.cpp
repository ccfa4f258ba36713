#include "nodes/emitters/nozzle_emitter.h"

#include <cmath>

namespace weir {

Emitter::Layer NozzleEmitter::layersOf(const SetupContext& context, const std::vector<Vec3f>& nodes) const {
  Layer layer;
  layer.points = nodes;
  if (isRelaxed(arrangement, request())) {
    const float spacing = request().spacing;
    const auto tile = tileOfSource(request(), seedFor(context), context.device, kTileHeight);
    // Nodes are at whole multiples of the spacing or halfway between them.
    const auto index = [spacing](float x) { return std::llround(std::floor(x / spacing + 0.25f)); };
    layer.layers = tile->height();
    layer.points.clear();
    for (int k = 0; k < tile->height(); ++k)  // against the flow, which is along -y
      for (const Vec3f& node : nodes)
        layer.points.push_back(node + spacing * tile->displacement(index(node.x), k, index(node.z)));
  }
  layer.directions.assign(layer.points.size(), Vec3f{0, -1, 0});
  return layer;
}

}  // namespace weir
