// Where a particle is and how fast, in 16 bytes: what a sum over neighbours gathers in one access in place of
// six, for sums whose weights need not be exact to the last digit (viscosity).
//
//   word 0, 1   velocity x, y: a float whose last 8 bits are a half of z
//   word 2      velocity z
//   word 3      y and x, 16 bits each
//
// Coordinates are counted in 65536ths of a range of 8 support radii, and modulo it: that is enough to tell
// how neighbours lie to each other, to 1/4096 of the radius, wherever they are. Velocities keep 16 bits of
// their mantissa. What two particles say of each other, decoded, is exactly opposite, so momentum is
// conserved as it is without codes.
#pragma once

#include <bit>
#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/parallel.h"

namespace weir {

class MotionCode {
 public:
  explicit MotionCode(float supportRadius) : inverseRange_(1 / (kRange * supportRadius)) {}

  WEIR_HD Vec4f of(const Vec3f& p, const Vec3f& v) const {
    const std::uint32_t x = counted(p.x), y = counted(p.y), z = counted(p.z);
    return {std::bit_cast<float>((std::bit_cast<std::uint32_t>(v.x) & ~kLast) | (z >> kHalf)),
            std::bit_cast<float>((std::bit_cast<std::uint32_t>(v.y) & ~kLast) | (z & kLast)), v.z,
            std::bit_cast<float>(y << kBits | x)};
  }

  /// Another particle as one sees it.
  struct Other {
    Vec3f away;    ///< its place less one's own, in units of unit()
    Vec3f faster;  ///< its velocity less one's own, m/s
  };

  /// What a particle needs to see others.
  class Sight {
   public:
    WEIR_HD explicit Sight(const Vec4f& own) : v_{own.x, own.y, own.z}, yx_(bits(own.w)), z_(upperZ(own)) {}

    WEIR_HD Other operator()(const Vec4f& code) const {
      // What stands below a coordinate in its word is less than a unit, and the same for both.
      const std::uint32_t yx = bits(code.w) - yx_;
      return {{signedOf(yx << kBits), signedOf(yx), signedOf(upperZ(code) - z_)},
              {code.x - v_.x, code.y - v_.y, code.z - v_.z}};
    }

    /// m, of one in `away`, for the radius that the codes were made with.
    static float unit(float supportRadius) { return kRange * supportRadius / kWord; }

   private:
    Vec3f v_;
    std::uint32_t yx_, z_;
  };

 private:
  static constexpr float kRange = 8;             // support radii
  static constexpr float kWord = 4294967296.0f;  // coordinates are decoded in the upper half of a word
  static constexpr int kBits = 16, kHalf = 8;
  static constexpr std::uint32_t kLast = (1u << kHalf) - 1;

  WEIR_HD static std::uint32_t bits(float word) { return std::bit_cast<std::uint32_t>(word); }
  /// z in the upper half of a word.
  WEIR_HD static std::uint32_t upperZ(const Vec4f& code) {
#ifdef __CUDA_ARCH__
    return __byte_perm(bits(code.x), bits(code.y), 0x0444);
#else
    return bits(code.x) << (kBits + kHalf) | (bits(code.y) & kLast) * 0x010101u;
#endif
  }
  WEIR_HD static float signedOf(std::uint32_t difference) {
    return static_cast<float>(static_cast<std::int32_t>(difference));
  }
  /// Finite numbers only; others become anything.
  WEIR_HD std::uint32_t counted(float coordinate) const {
    constexpr float kUnits = 1 << kBits;
    const float ranges = coordinate * inverseRange_;
    return static_cast<std::uint32_t>(kUnits * (ranges - floorf(ranges))) & 0xffffu;
  }

  float inverseRange_;
};

/// Writes the code of a particle that has moved. Codes are for CUDA, where no index stands for several
/// particles: for lanes of them nothing is written.
template <class Index>
WEIR_HD void writeCode(const ArrayView<Vec4f>& to, const Index& i, const MotionCode& code, const Vec3f& p,
                       const Vec3f& v) {
  write(to, i, code.of(p, v));
}
template <class Index, class T>
WEIR_HD void writeCode(const ArrayView<Vec4f>&, const Index&, const MotionCode&, const Vec3<T>&,
                       const Vec3<T>&) {}

}  // namespace weir
