#include "nodes/body_contacts/joint.h"

namespace weir {

void Joint::validate() const {
  if (!(weir::length(axis.get()) > 0))
    throw sceneError("the axis has no length", "an axis such as [0, 1, 0]").inParameter(axis.name());
  if (other.linked() && other.links().front() == body.links().front())
    throw sceneError("both ends are the same body", "two bodies, or one and the world");
  if (motor && effort.get() != 0)
    throw sceneError("both a motor and an effort are given", "one of them").inParameter(effort.name());
}

HeldJoint Joint::between(int a, int b) const {
  HeldJoint held{.kind = kind, .a = a, .b = b, .stiffness = stiffness, .damping = damping};
  held.anchor = doubleOf(anchor);
  held.otherAnchor = doubleOf(otherAnchor);
  const Vec3d along = doubleOf(axis);
  held.axis = along / weir::length(along);
  held.length = length.get().value_or(weir::length(held.anchor - held.otherAnchor));
  return held;
}

JointDrive Joint::drive() const {
  if (kind != JointKind::kHinge && kind != JointKind::kSlider) return {};
  if (motor) return {speed.get(), maxEffort};
  return {std::nullopt, effort};
}

}  // namespace weir
