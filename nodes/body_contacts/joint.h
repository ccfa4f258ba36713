// What holds a body to another one, or to the world.
#pragma once

#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/graph/node.h"
#include "nodes/body_contacts/body_dynamics.h"
#include "nodes/rigid_body/rigid_body.h"

namespace WEIR_API weir {

template <>
struct EnumNames<JointKind> {
  static constexpr std::array<EnumName, 5> kNames{
      EnumName{"fixed", "Nothing moves."}, EnumName{"hinge", "Turns about the axis alone."},
      EnumName{"slider", "Moves along the axis alone."},
      EnumName{"spring", "Pulls the two ends together, and pushes them apart."},
      EnumName{"ball", "Turns about the anchor in any way."}};
};

class Joint;

/// What travels along links.
struct JointLink {
  static constexpr std::string_view kPortType = "Joint";
  const Joint* joint = nullptr;
};

class Joint final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{
      "Joint", "Holds a body to another one or to the world.",
      "hinge, slider, spring, ball, socket, motor, constraint, axle, wheel, pendulum, weld"};
  const NodeInfo& info() const override { return kInfo; }

  Joint() { joint->joint = this; }

  Param<JointKind> kind{*this, "kind", JointKind::kHinge, {.doc = "What it leaves free."}};
  Param<Vec3f> anchor{*this, "anchor", {}, {.unit = "m", .doc = "Where it holds the body, at the start."}};
  Param<Vec3f> axis{*this,
                    "axis",
                    {0, 1, 0},
                    {.doc = "At the start; of any length but 0.", .onlyFor = "kind: hinge, slider"}};
  Param<std::optional<Vec2f>> limits{
      *this,
      "limits",
      std::nullopt,
      {.doc =
           "How far the body may turn (degrees) or move (m) relative to the other, from its start: the least "
           "and the most, with 0 between them. Without limits if it is left out.",
       .onlyFor = "kind: hinge, slider"}};
  Param<Vec3f> otherAnchor{
      *this,
      "other_anchor",
      {},
      {.unit = "m", .doc = "Where the spring ends, at the start.", .onlyFor = "kind: spring"}};
  Param<double> stiffness{*this,
                          "stiffness",
                          1000,
                          {.unit = "N/m", .min = 0, .doc = "Of the spring.", .onlyFor = "kind: spring"}};
  Param<double> damping{
      *this, "damping", 0, {.unit = "N*s/m", .min = 0, .doc = "Of the spring.", .onlyFor = "kind: spring"}};
  Param<std::optional<double>> length{*this,
                                      "length",
                                      std::nullopt,
                                      {.unit = "m",
                                       .min = 0,
                                       .doc = "Of the spring at rest; as at the start if it is left out.",
                                       .onlyFor = "kind: spring"}};
  Param<bool> motor{
      *this,
      "motor",
      false,
      {.doc = "Whether it keeps to the speed, with max_effort at most.", .onlyFor = "kind: hinge, slider"}};
  Param<double> speed{*this,
                      "speed",
                      0,
                      {.live = true,
                       .animated = true,
                       .doc = "Of the motor: of the body relative to the other; rad/s, or m/s of a slider.",
                       .onlyFor = "kind: hinge, slider"}};
  Param<double> maxEffort{*this,
                          "max_effort",
                          1e6,
                          {.min = 0,
                           .live = true,
                           .animated = true,
                           .doc = "Of the motor: N*m, or N of a slider.",
                           .onlyFor = "kind: hinge, slider"}};
  Param<double> effort{*this,
                       "effort",
                       0,
                       {.live = true,
                        .animated = true,
                        .doc = "On the body about or along the axis, without a motor: N*m, or N of a slider.",
                        .onlyFor = "kind: hinge, slider"}};

  Input<BodyLink> body{*this, "body", "The body that it holds."};
  Input<BodyLink> other{*this, "other", "The body that it is held to; the world if none is linked.", false};
  Output<JointLink> joint{*this, "joint", "For the BodyContacts of these bodies."};

  void validate() const override;
  void configure(const SetupContext& context) override;
  void reset(const SetupContext&) override {}

  /// Between bodies with these numbers.
  HeldJoint between(int a, int b) const;
  JointDrive drive() const;

 private:
  void checkLimits() const;
};

}  // namespace weir
