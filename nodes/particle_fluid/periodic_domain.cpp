#include "nodes/particle_fluid/periodic_domain.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "framework/base/error.h"

namespace weir {

namespace {

constexpr std::string_view kAxes = "xyz";

bool has(PeriodicAxes axes, int axis) {
  const std::string_view name = EnumNames<PeriodicAxes>::kNames[std::size_t(axes)].first;
  return name.find(kAxes[std::size_t(axis)]) != std::string_view::npos;
}

/// Where a solid reaches through the faces on one side of the box, it must do so on the other.
bool looksTheSame(float low, float high, float boxLow, float boxHigh, float reach) {
  const bool within = low >= boxLow + reach && high <= boxHigh - reach;
  const bool through = low <= boxLow - reach && high >= boxHigh + reach;
  const bool away = high <= boxLow - reach || low >= boxHigh + reach;
  return within || through || away;
}

void checkBounds(const Period& period, const Aabb& bounds, float reach, const std::string& named) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!period.along(axis)) continue;
    const float low = period.lo[axis], high = low + period.size[axis];
    if (looksTheSame(bounds.lo[axis], bounds.hi[axis], low, high, reach)) continue;
    throw sceneError(
        fmt::format("{} reaches from {:.4g} to {:.4g} m along {}, where the domain is periodic "
                    "from {:.4g} to {:.4g} m, so the fluid would not meet the same solid through "
                    "both faces",
                    named, bounds.lo[axis], bounds.hi[axis], kAxes[std::size_t(axis)], low, high),
        fmt::format("a solid that goes on to {:.4g} and {:.4g} m or beyond, or that lies between "
                    "{:.4g} and {:.4g} m",
                    low - reach, high + reach, low + reach, high - reach));
  }
}

void checkPlane(const Period& period, const Vec3f& normal, const std::string& named) {
  constexpr float kStraight = 1e-4f;
  for (int axis = 0; axis < 3; ++axis)
    if (period.along(axis) && std::abs(normal[axis]) > kStraight)
      throw sceneError(fmt::format("{} is a plane across {}, along which the domain is periodic", named,
                                   kAxes[std::size_t(axis)]),
                       fmt::format("a plane whose normal has no part along {}", kAxes[std::size_t(axis)]));
}

}  // namespace

Period periodOf(PeriodicAxes axes, const std::optional<Vec3f>& low, const std::optional<Vec3f>& high,
                float supportRadius) {
  Period period;
  if (axes == PeriodicAxes::kNone) return period;
  if (!low || !high)
    throw sceneError("the domain is periodic, but not both of domain_min and domain_max are given",
                     "both: the faces that are joined");
  period.lo = *low;
  constexpr float kRounding = 1e-3f;
  for (int axis = 0; axis < 3; ++axis) {
    if (!has(axes, axis)) continue;
    period.size[axis] = (*high)[axis] - (*low)[axis];
    if (!(period.size[axis] >= 2 * supportRadius * (1 - kRounding)) || !std::isfinite(period.size[axis]))
      throw sceneError(
          fmt::format("the domain is {:.4g} m long along {}, along which it is periodic", period.size[axis],
                      kAxes[std::size_t(axis)]),
          fmt::format("at least {:.4g} m, twice the radius in which particles interact", 2 * supportRadius));
  }
  return period;
}

void checkSolid(const Period& period, const BoundaryPiece& piece, float reach, const std::string& named) {
  if (!period.any()) return;
  if (!piece.isMesh && piece.shape.kind == ShapeKind::kPlane)
    return checkPlane(period, rotate(piece.shape.rotation, {0, 1, 0}), named);
  if (!piece.bounded)
    throw sceneError(named + " has a shape that cannot be in a periodic domain", "another shape");
  checkBounds(period, piece.bounds, reach, named);
}

void checkSolid(const Period& period, const SolidView& solid, float reach, const std::string& named) {
  if (!period.any()) return;
  const Aabb& own = solid.tree.bounds;
  Aabb bounds;
  for (int corner = 0; corner < 8; ++corner)
    bounds.extend(
        solid.end.toWorld({(corner & 1) != 0 ? own.hi.x : own.lo.x, (corner & 2) != 0 ? own.hi.y : own.lo.y,
                           (corner & 4) != 0 ? own.hi.z : own.lo.z}));
  checkBounds(period, bounds, reach, named);
}

void checkBatch(const Period& period, const ParticleBatch& batch, const std::string& named) {
  if (!period.any()) return;
  for (const Vec3f& p : batch.positions.toHost(batch.count)) {
    if (!isFinite(p) || period.wrapped(p) == p) continue;
    throw sceneError(
        fmt::format("particles of '{}' start outside of the periodic domain, at ({:.4g}, {:.4g}, "
                    "{:.4g}) m",
                    named, p.x, p.y, p.z),
        "particles within domain_min and domain_max along the axes of periodic");
  }
}

}  // namespace weir
