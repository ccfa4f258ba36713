// A landscape made from a few numbers: slopes and cliffs, a river bed, rough ground, rocks.
#pragma once

#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/graph/node.h"
#include "nodes/terrain/heightfield.h"

namespace WEIR_API weir {

class Terrain final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{"Terrain", "A landscape: slopes, cliffs, a river bed, rough ground, rocks.",
                                  "landscape, ground, river, valley, mountain, hill, rocks"};
  const NodeInfo& info() const override { return kInfo; }

  Param<Vec2f> size{
      *this, "size", {4, 4}, {.unit = "m", .min = 0, .aboveMin = true, .doc = "Length along x and along z."}};
  Param<int> cells{
      *this,
      "cells",
      64,
      {.min = 1,
       .max = 2048,
       .doc = "Squares of two triangles along the longer side; along the other, as many of about "
              "the same size."}};
  Param<Curve> profile{
      *this,
      "profile",
      Curve{{{0, 0}}},
      {.unit = "m",
       .minItems = 1,
       .doc = "Points [x, height], x increasing, x = 0 in the middle: slopes, steps and cliffs."}};
  Param<float> channelWidth{
      *this, "channel_width", 0, {.unit = "m", .min = 0, .doc = "Width of a river bed along x, at z = 0."}};
  Param<float> channelDepth{
      *this, "channel_depth", 0, {.unit = "m", .min = 0, .doc = "Depth of the river bed."}};
  Param<float> roughness{
      *this, "roughness", 0, {.unit = "m", .min = 0, .doc = "Height of the largest bumps, up and down."}};
  Param<float> featureSize{
      *this,
      "feature_size",
      1,
      {.unit = "m", .min = 0, .aboveMin = true, .doc = "Distance of the largest bumps."}};
  Param<int> octaves{
      *this,
      "octaves",
      4,
      {.min = 1, .max = 12, .doc = "Sizes of bumps, each half as large and half as high as the last."}};
  Param<Vec2f> bumpOffset{
      *this,
      "bump_offset",
      {},
      {.unit = "m",
       .doc = "Moves the bumps by as much the other way along x and z: those of terrains of one "
              "seed whose offsets are their positions go on in each other.",
       .also = "noise, tiling, seam"}};
  Param<int> rocks{*this, "rocks", 0, {.min = 0, .max = 1000, .doc = "Number of rocks."}};
  Param<Vec2f> rockSize{
      *this,
      "rock_size",
      {0.1f, 0.3f},
      {.unit = "m", .min = 0, .aboveMin = true, .doc = "Least and largest radius of rocks."}};
  Param<std::optional<Vec2f>> rockRange{
      *this,
      "rock_range",
      std::nullopt,
      {.unit = "m", .doc = "Least and largest x of rocks; anywhere if it is left out."}};
  Param<std::optional<std::int64_t>> seed{*this, "seed", std::nullopt, kSeedSpec};
  Param<float> thickness{
      *this,
      "thickness",
      0.2f,
      {.unit = "m", .min = 0, .aboveMin = true, .doc = "Of the ground below its lowest point."}};
  Param<Vec3f> position{*this, "position", {}, {.unit = "m", .doc = "Where x = 0, z = 0 and height 0 are."}};

  Output<TriangleMesh> surface{*this, "surface", "The ground as a closed solid."};

  void validate() const override;
  /// Makes the mesh, as others tell by it what they need.
  void estimate(const SetupContext& context, MemoryNeeds&) override { reset(context); }
  void reset(const SetupContext& context) override;
};

}  // namespace weir
