// Particles on their way into a fluid: what samplers, files and emitters put out.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"
#include "framework/compute/array.h"
#include "framework/graph/param_types.h"
#include "framework/particles/attribute_types.h"
#include "framework/particles/period.h"

namespace WEIR_API weir {

struct Boundary;

/// How particles rest in their container.
enum class StartPressure { kAuto, kHydrostatic, kNone };
template <>
struct EnumNames<StartPressure> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"auto", "That of fluid at rest where walls hold it, none where it is free to move away."},
      EnumName{"hydrostatic", "That of fluid which stands in the region as in a container."},
      EnumName{"none", "That of fluid in the air."}};
};

/// What particles bring with them beside position and velocity.
struct BatchAttribute {
  AttributeInfo info;                            ///< not derived
  AttributeTypes::VariantOf<Array> values = {};  ///< one a particle, of the type of `info`
};

/// The first `count` elements of the arrays are particles, on the scene's device. A sampler fills it in
/// reset(); an emitter refills it in every step with the particles born in that step, placed where they are
/// at the beginning of the step.
struct ParticleBatch {
  static constexpr std::string_view kPortType = "ParticleBatch";

  /// What a fluid asks of its sources.
  struct Request {
    float spacing = 0;        ///< m
    float supportRatio = 0;   ///< H/d
    bool disordered = false;  ///< settled fluid has rest density, not a cubic lattice
    Period period;            ///< of the space in which they live
    friend bool operator==(const Request&, const Request&) = default;
  };

  std::int64_t count = 0;
  Array<Vec3f> positions;   ///< m
  Array<Vec3f> velocities;  ///< m/s; empty where all have the same
  Vec3f velocity{};         ///< m/s, of all in that case
  /// How many particles come this way in the whole run at most; told before there are any.
  double maxCount = 0;
  /// The fluid that takes the particles gets these attributes; other particles have 0 there. Which ones they
  /// are is told before there are values.
  std::vector<BatchAttribute> attributes;

  /// Where the fluid may rest until the simulation starts, as RestState makes it; nowhere if it is null.
  std::shared_ptr<const Boundary> container;
  float contact = 0;  ///< m, distance that particles keep from it
  StartPressure pressure = StartPressure::kAuto;

  /// The velocities as kernels see them.
  struct VelocityView {
    ArrayView<const Vec3f> each;
    Vec3f ofAll;
    WEIR_HD Vec3f operator[](std::int64_t i) const { return each.size > 0 ? each[i] : ofAll; }
  };
  VelocityView velocityView() const { return {velocities.view(), velocity}; }

  /// Replaces the contents by host data, with one velocity for all.
  void assign(Device& device, std::span<const Vec3f> hostPositions, const Vec3f& velocityOfAll) {
    count = static_cast<std::int64_t>(hostPositions.size());
    positions = Array<Vec3f>(device, hostPositions);
    velocities = Array<Vec3f>(device);
    velocity = velocityOfAll;
  }
  /// The same with host data of equal length.
  void assign(Device& device, std::span<const Vec3f> hostPositions, std::span<const Vec3f> hostVelocities) {
    WEIR_CHECK(hostPositions.size() == hostVelocities.size());
    count = static_cast<std::int64_t>(hostPositions.size());
    positions = Array<Vec3f>(device, hostPositions);
    velocities = Array<Vec3f>(device, hostVelocities);
  }
};

}  // namespace weir
