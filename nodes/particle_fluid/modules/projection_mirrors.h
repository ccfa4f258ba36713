// Pairs of TwoProjections (two_projections.h) as walls mirror them.
//
// Beside a wall a particle has neighbours on one side, so N would be twice as large along it as inside the
// fluid, and Dᵀ of a pressure that grows along the wall would push the first layer less than the next. Were
// all particles mirrored at a plane, particle i would meet the image of j at √(r_t² + (y_i + y_j)²) =
// √(r² + 4·y_i·y_j), y being distances from the plane. So each pair gains that image's weight,
// a' = a(√(r² + 4·y_i·y_j)): in all continuous fluid M is then what it is inside. Linear fields stay exact
// whatever the weights are; and as a' asks for no normal it is the same from both sides at walls of any
// shape, which keeps momentum. Where several walls are near, they mirror images as well: √(r² + Σ 4·y_i·y_j)
// over each set of them.
#pragma once

#include <cstdint>

#include "nodes/particle_fluid/pair_gradient.h"

namespace weir::projection {

/// The nearest walls of a particle, up to three.
struct NearWalls {
  static constexpr int kMost = 3, kBase = 256;
  float distance[kMost] = {0, 0, 0};  ///< m
  int key[kMost] = {0, 0, 0};         ///< of a wall; 0 is none; every 255th has the same

  NearWalls() = default;
  WEIR_HD NearWalls(const Vec3f& distances, float keys) : distance{distances.x, distances.y, distances.z} {
    int rest = static_cast<int>(keys);
    for (int& one : key) one = rest % kBase, rest /= kBase;
  }
  WEIR_HD Vec3f distances() const { return {distance[0], distance[1], distance[2]}; }
  /// As digits of a whole number below 2²⁴, which a float holds, as what ranks exchange are floats.
  WEIR_HD float keys() const { return static_cast<float>(key[0] + kBase * (key[1] + kBase * key[2])); }
  /// Of wall `number`, in the place of the farthest if there are three that are nearer.
  WEIR_HD void add(float y, int number) {
    int place = 0;
    for (int k = 1; k < kMost; ++k)
      if (key[place] != 0 && (key[k] == 0 || distance[k] > distance[place])) place = k;
    if (key[place] != 0 && distance[place] <= y) return;
    distance[place] = y;
    key[place] = 1 + number % (kBase - 1);
  }
};

/// a' of a pair at the distance √square.
WEIR_HD inline float mirroredWeight(const PairGradient& gradient, float square, const NearWalls& own,
                                    const NearWalls& other) {
  float farther[NearWalls::kMost];
  int common = 0;
  for (int k = 0; k < NearWalls::kMost; ++k)
    for (int l = 0; l < NearWalls::kMost; ++l)
      if (own.key[k] != 0 && own.key[k] == other.key[l])
        farther[common++] = 4 * own.distance[k] * other.distance[l];
  float sum = 0;
  for (int set = 1; set < 1 << common; ++set) {
    float squares = square;
    for (int k = 0; k < common; ++k)
      if ((set >> k & 1) != 0) squares += farther[k];
    sum += gradient.weight(sqrtf(squares));
  }
  return sum;
}

}  // namespace weir::projection
