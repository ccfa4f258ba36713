#include "nodes/square_emitter/square_emitter.h"
#include "framework/compute/parallel.h"

namespace weir {

namespace {

struct PlaceLayer {
  Vec3f center, xAxis, zAxis, direction;
  int columns, rows;
  float spacing, speed, firstOffset;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t inLayer = static_cast<std::int64_t>(columns) * rows;
    const auto layer = static_cast<float>(k / inLayer);
    const int inPlane = static_cast<int>(k % inLayer);
    const float x =
        (static_cast<float>(inPlane % columns) - 0.5f * static_cast<float>(columns - 1)) * spacing;
    const float z = (static_cast<float>(inPlane / columns) - 0.5f * static_cast<float>(rows - 1)) * spacing;
    positions[k] = center + x * xAxis + z * zAxis - (firstOffset + layer * spacing) * direction;
    velocities[k] = speed * direction;
  }
};

}  // namespace

template <class Backend>
void SquareEmitter::emitOn(Backend& device, std::int64_t count, double firstOffset) {
  const Quatf q = rotation->toQuaternion();
  parallelFor(device, "emit", count,
              PlaceLayer{position, rotate(q, {1, 0, 0}), rotate(q, {0, 0, 1}), rotate(q, {0, -1, 0}),
                         columns_, rows_, spacing_, speed, static_cast<float>(firstOffset),
                         particles->positions.view(), particles->velocities.view()});
}

template void SquareEmitter::emitOn(ThisBackend&, std::int64_t, double);

}  // namespace weir
