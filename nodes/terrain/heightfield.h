// Ground for fluids to run over: a height over a rectangle, from a profile, noise and rocks, and its solid.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

/// A height y for each point of the rectangle |x| ≤ size.x/2, |z| ≤ size.y/2; lengths in m.
struct HeightfieldShape {
  Vec2f size{4, 4};
  std::vector<Vec2f> profile{{0, 0}};  ///< [x, height], x increasing; linear between, held beyond the ends
  float channelWidth = 0;              ///< of the valley along z = 0; 0 for none
  float channelDepth = 0;
  float roughness = 0;    ///< amplitude of the noise's coarsest octave
  float featureSize = 1;  ///< of its bumps
  int octaves = 4;        ///< each of half the size and half the amplitude of the one before
  Vec2f bumpOffset{};     ///< the place in the noise, which has no end, of x = 0, z = 0
  int rocks = 0;
  Vec2f rockSize{0.1f, 0.3f};  ///< least and largest radius
  Vec2f rockRange{-2, 2};      ///< of the x at which they stand
  std::uint64_t seed = 0;
};

class Heightfield {
 public:
  explicit Heightfield(HeightfieldShape shape);

  double height(double x, double z) const;
  /// The solid between the heights at a grid of cells.x × cells.y squares and a flat bottom `thickness` below
  /// the lowest of them: closed, counter-clockwise seen from outside.
  TriangleMesh solid(int cellsAlongX, int cellsAlongZ, double thickness) const;

 private:
  /// Half an ellipsoid that stands out of the ground.
  struct Rock {
    double x, z, radius, height;
  };

  double profileHeight(double x) const;
  double channelCut(double z) const;
  double noiseHeight(double x, double z) const;
  double ground(double x, double z) const;  // without rocks
  void placeRocks();

  HeightfieldShape shape_;
  std::vector<Rock> rocks_;
};

}  // namespace weir
