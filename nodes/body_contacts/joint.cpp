#include "nodes/body_contacts/joint.h"

#include <fmt/format.h>

#include <numbers>

namespace weir {

namespace {

constexpr float kMostTurn = 175;  // degrees: turns of half a circle either way are the same place

}  // namespace

void Joint::validate() const {
  if (!(weir::length(axis.get()) > 0))
    throw sceneError("the axis has no length", "an axis such as [0, 1, 0]").inParameter(axis.name());
  checkLimits();
  if (motor && effort.get() != 0)
    throw sceneError("both a motor and an effort are given", "one of them").inParameter(effort.name());
}

void Joint::configure(const SetupContext&) {
  if (other.linked() && other.links().front() == body.links().front())
    throw sceneError("both ends are the same body", "two bodies, or one and the world");
}

void Joint::checkLimits() const {
  if (!limits.get()) return;
  const auto [least, most] = *limits.get();
  const bool turns = kind == JointKind::kHinge;
  if (least <= 0 && most >= 0 && (!turns || (least > -kMostTurn && most < kMostTurn))) return;
  throw sceneError(
      fmt::format("found limits of {:g} and {:g}", least, most),
      turns ? fmt::format("at most 0 and at least 0, both between -{0:g} and {0:g} degrees", kMostTurn)
            : "at most 0 and at least 0")
      .inParameter(limits.name());
}

HeldJoint Joint::between(int a, int b) const {
  HeldJoint held{.kind = kind, .a = a, .b = b, .stiffness = stiffness, .damping = damping};
  held.anchor = doubleOf(anchor);
  held.otherAnchor = doubleOf(otherAnchor);
  const Vec3d along = doubleOf(axis);
  held.axis = along / weir::length(along);
  if (limits.get()) {
    const double unit = kind == JointKind::kHinge ? std::numbers::pi / 180 : 1;
    held.limits = {unit * double(limits.get()->x), unit * double(limits.get()->y)};
  }
  held.length = length.get().value_or(weir::length(held.anchor - held.otherAnchor));
  return held;
}

JointDrive Joint::drive() const {
  if (kind != JointKind::kHinge && kind != JointKind::kSlider) return {};
  if (motor) return {speed.get(), maxEffort};
  return {std::nullopt, effort};
}

}  // namespace weir
