#include "nodes/terrain/terrain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace weir {

void Terrain::validate() const {
  const auto& points = profile->points;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (!(points[i].x > points[i - 1].x))
      throw sceneError(fmt::format("point {} of the profile, at x = {}, is not beyond the one before, at {}",
                                   i, points[i].x, points[i - 1].x),
                       "points [x, height] in the order of x",
                       "a cliff needs two points that are a little apart")
          .inParameter(profile.name());
  if (rockSize->x > rockSize->y)
    throw sceneError(fmt::format("found [{}, {}]", rockSize->x, rockSize->y),
                     "[least, largest] with least not above largest")
        .inParameter(rockSize.name());
  if (const auto& range = rockRange.get(); range && range->x > range->y)
    throw sceneError(fmt::format("found [{}, {}]", range->x, range->y),
                     "[least, largest] with least not above largest")
        .inParameter(rockRange.name());
  if (channelDepth > 0 && channelWidth == 0)
    throw sceneError("the river bed has a depth but no width", "both, or none")
        .inParameter(channelDepth.name());
}

void Terrain::reset(const SetupContext& context) {
  const Heightfield field({.size = size,
                           .profile = profile->points,
                           .channelWidth = channelWidth,
                           .channelDepth = channelDepth,
                           .roughness = roughness,
                           .featureSize = featureSize,
                           .octaves = octaves,
                           .bumpOffset = bumpOffset,
                           .rocks = rocks,
                           .rockSize = rockSize,
                           .rockRange = rockRange.get().value_or(Vec2f{-0.5f * size->x, 0.5f * size->x}),
                           .seed = randomSeed(*this, context, seed)});
  const float cell = std::max(size->x, size->y) / static_cast<float>(cells.get());
  const auto along = [&](float length) { return std::max(1, static_cast<int>(std::lround(length / cell))); };
  *surface = field.solid(along(size->x), along(size->y), thickness);
  surface->transform(1, Quatf{}, position);
}

}  // namespace weir
