#include "nodes/turning_model/turning_model.h"

#include <fmt/format.h>

namespace weir {

void TurningModel::validate() const {
  if (profile->points.empty())
    throw sceneError("the node has no profile", "a list of points [radius, height] in \"profile\"")
        .inParameter(profile.name());
  if (thickness.get() && caps.isSet() && caps)
    throw sceneError("both caps and a thickness are given, but a wall has no caps", "one of them")
        .inParameter(caps.name());
  const std::size_t vertices = outline().points.size() * static_cast<std::size_t>(segments.get());
  constexpr std::size_t kMaxVertices = 5'000'000;
  if (vertices > kMaxVertices)
    throw sceneError(fmt::format("{} segments make {} vertices of this profile", segments.get(), vertices),
                     fmt::format("at most {} vertices", kMaxVertices))
        .inParameter(segments.name());
}

Outline TurningModel::outline() const {
  try {
    return revolutionOutline(profile->points, {.caps = caps, .thickness = thickness.get()});
  } catch (Error& e) {
    throw e.inParameter(profile.name());
  }
}

void TurningModel::reset(const SetupContext&) {
  *surface = surfaceOfRevolution(outline(), segments);
  surface->transform(1, rotation->toQuaternion(), position);
}

}  // namespace weir
