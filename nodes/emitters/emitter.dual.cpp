#include "nodes/emitters/emitter.h"

#include "framework/base/random.h"
#include "framework/compute/parallel.h"

namespace weir {

namespace {

struct PlaceLayers {
  Vec3f origin, xAxis, yAxis, zAxis;  // of the emitter's frame
  ArrayView<const Vec3f> points, directions;
  float spacing, speed, firstOffset;
  float jitter;  // m
  std::uint64_t seed;
  std::int64_t firstNumber;  // of the first particle, among all that are emitted
  std::int64_t inLayer;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD Vec3f turned(const Vec3f& v) const { return v.x * xAxis + v.y * yAxis + v.z * zAxis; }

  WEIR_HD Vec3f displacement(std::int64_t number) const {
    const auto index = static_cast<std::uint64_t>(3 * number);
    return jitter * Vec3f{static_cast<float>(noise(seed, index)), static_cast<float>(noise(seed, index + 1)),
                          static_cast<float>(noise(seed, index + 2))};
  }

  WEIR_HD void operator()(std::int64_t k) const {
    const auto layer = static_cast<float>(k / inLayer);
    const std::int64_t point = (firstNumber + k) % points.size;
    const Vec3f p = points[point];
    const Vec3f direction = turned(directions[point]);
    Vec3f position =
        origin + p.x * xAxis + p.y * yAxis + p.z * zAxis - (firstOffset + layer * spacing) * direction;
    if (jitter > 0) position += displacement(firstNumber + k);
    positions[k] = position;
    velocities[k] = speed * direction;
  }
};

}  // namespace

template <class Backend>
void Emitter::emitOn(Backend& device, std::int64_t count, double firstOffset, float flowSpeed) {
  const Frame f = axes();
  parallelFor(device, "emit", count,
              PlaceLayers{f.origin, f.xAxis, f.yAxis, f.zAxis, points_.view(), directions_.view(), spacing_,
                          flowSpeed, static_cast<float>(firstOffset), jitter * spacing_, seed_, emitted_,
                          inLayer_, particles->positions.view(), particles->velocities.view()});
}

template void Emitter::emitOn(ThisBackend&, std::int64_t, double, float);

}  // namespace weir
