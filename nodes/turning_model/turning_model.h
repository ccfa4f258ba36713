// A body turned on a lathe: a profile that goes round the node's y axis.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/geometry/surface_of_revolution.h"
#include "framework/graph/node.h"

namespace WEIR_API weir {

class TurningModel final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{"TurningModel", "A surface of revolution from a profile, such as a goblet.",
                                  "goblet, glass, bottle, vase, lathe, revolve, cup, bowl"};
  const NodeInfo& info() const override { return kInfo; }

  Param<Curve> profile{
      *this,
      "profile",
      {},
      {.unit = "m",
       .minItems = 2,
       .doc = "Points [radius, height], either way round. It may end on the axis, or be closed."}};
  Param<int> segments{*this,
                      "segments",
                      64,
                      {.min = 3, .max = 4096, .softMin = 16, .softMax = 256, .doc = "Steps of the turn."}};
  Param<bool> caps{
      *this,
      "caps",
      true,
      {.doc = "Closes those ends of the profile that are not on the axis by discs; not with a thickness."}};
  Param<std::optional<float>> thickness{
      *this,
      "thickness",
      std::nullopt,
      {.unit = "m",
       .min = 0,
       .aboveMin = true,
       .doc = "Makes a wall of the open profile, which is the wall's outer side."}};
  Param<Vec3f> position{*this, "position", {}, {.unit = "m", .doc = "Where the profile's [0, 0] is."}};
  Param<Rotation> rotation{
      *this, "rotation", {}, {.unit = "degrees", .doc = "Turns the body about position."}};

  Output<TriangleMesh> surface{*this, "surface", "The surface, facing outwards."};

  void validate() const override;
  /// Makes the mesh, as others tell by it what they need.
  void estimate(const SetupContext& context, MemoryNeeds&) override { reset(context); }
  void reset(const SetupContext& context) override;

 private:
  Outline outline() const;
};

}  // namespace weir
