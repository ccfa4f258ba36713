// Where particles are to a 64th of a cell, and from that whether two of them may be near each other.
//
// A search tests many candidates and keeps few of them. The test here takes four instructions on CUDA and
// four bytes of a candidate. It lets some pass that are a bit too far, and none that is near is lost.
#pragma once

#include <cmath>
#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// A place in 64ths of a cell, modulo four cells: bytes of x, y and z from the highest down, and a zero.
struct FineCell {
  static constexpr int kSteps = 64;
  /// Places have this precision up to that many cells from the origin.
  static constexpr float kFarthest = 4096;
  /// That many are read behind the last of an array; they mean nothing.
  static constexpr int kAhead = 3;

  std::uint32_t bytes = 0;

  WEIR_HD static FineCell of(const Vec3f& p, float inverseCellSize) {
    const Vec3f at = float{kSteps} * inverseCellSize * p;
    return of(rounded(at.x), rounded(at.y), rounded(at.z));
  }
  WEIR_HD static FineCell of(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    constexpr std::uint32_t kByte = 0xff;
    return {x << 24 | (y & kByte) << 16 | (z & kByte) << 8};
  }
  /// Down to a whole number. Those far away come out wrong.
  WEIR_HD static std::uint32_t rounded(float x) {
#ifdef __CUDA_ARCH__
    return static_cast<std::uint32_t>(__float2int_rd(x));
#else
    constexpr float kMax = 1e9f;
    const float down = std::floor(x);
    return down > -kMax && down < kMax ? static_cast<std::uint32_t>(static_cast<int>(down)) : 0;
#endif
  }
};

/// Asks of particles in the cells around one whether they may be less than a cell's width from it.
///
/// All three differences are found by one subtraction. Where a byte becomes negative, it takes one from the
/// byte above, so with G for a coordinate in 64ths the error of a difference is
///   z: G's fraction of one less that of the other: from -1 to 1,
///   x, y: that, and down to one less: from -2 to 1, or, for a point that is asked for half a step further
///   down, from -1.5 to 1.5.
/// Up to 4,096 cells from the origin, products and differences of floats are rounded by less than a 16th in
/// all. So the vector of differences is wrong by less than |(1.5625, 1.5625, 1.0625)| < 2.452, and that of
/// two particles within 64·(1 + 10⁻⁶) is shorter than 66.4521, its square less than 4416. Differences are
/// modulo four cells. Of particles in neighbouring cells they are between -2 and 2 cells; of others, which
/// share cells in a grid that wraps around, they may be anything.
class FineReach {
 public:
  WEIR_HD FineReach(const Vec3f& p, float inverseCellSize) {
    constexpr float kHalf = 0.5f;
    const Vec3f at = float{FineCell::kSteps} * inverseCellSize * p;
    own_ = FineCell::of(FineCell::rounded(at.x - kHalf), FineCell::rounded(at.y - kHalf),
                        FineCell::rounded(at.z))
               .bytes;
  }

  /// Negative if it may be near.
  WEIR_HD int beyond(FineCell other) const {
    constexpr int kReachSquared = 4416;
    const std::uint32_t difference = other.bytes - own_;
#ifdef __CUDA_ARCH__
    return __dp4a(static_cast<int>(difference), static_cast<int>(difference), -kReachSquared);
#else
    int sum = -kReachSquared;
    for (int byte = 1; byte < 4; ++byte) {
      const int d = static_cast<std::int8_t>(difference >> 8 * byte & 0xff);
      sum += d * d;
    }
    return sum;
#endif
  }

  /// Whether what beyond() says of particles near a point can be relied upon.
  WEIR_HD static bool covers(const Vec3f& p, float inverseCellSize) {
    const Vec3f at = inverseCellSize * p;
    return fmaxf(fmaxf(fabsf(at.x), fabsf(at.y)), fabsf(at.z)) < FineCell::kFarthest;
  }

 private:
  std::uint32_t own_;
};

}  // namespace weir
