// Which of the particles around a cell may be near one of its particles, 64 of them at a time.
//
// Coordinates are rounded to 16 bits, so that a register of 256 bits holds those of 16 candidates. That lets
// some pass that are a bit too far, about one in 300 of those that are near, and none that is near is lost.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "framework/compute/eight.h"
#include "framework/neighbors/halo_order.h"

#ifdef __SSE2__
#include <immintrin.h>
#endif

#ifdef WEIR_HAS_LANES

namespace weir::detail {

/// A coordinate in 8192ths of a cell, towards zero, modulo eight cells. Differences are right between
/// particles less than four cells apart.
struct ShortPlace {
  static constexpr float kSteps = 8192;
  /// Cells from the origin, up to which places have any meaning.
  static constexpr float kFarthest = 1 << 17;

  std::int16_t x, y, z;

  /// Of that many steps.
  template <class T>
  static T inRange(const T& steps) {
    using std::abs;
    return select(abs(steps) < T(kSteps * kFarthest), steps, T(0));
  }
};

/// What the squared difference of two places, as mayBeNear() computes it, is at most if they are within a
/// cell's width. `farthest` is the particle's largest coordinate in cells.
///
/// A step is lost in each direction where places are rounded down, and where coordinates of particles within
/// a cell of each other are multiplied, each product is wrong by 2⁻²⁴ of it. So a difference is wrong by
/// `error` at most, and the vector of three by √3 times that. Squares are rounded down.
template <class T>
T reachOf(const T& farthest) {
  constexpr float kRoot3 = 1.7320509f, kRounding = 1.2e-7f, kSlack = 1.001f, kMax = 32767;
  constexpr float kUnit = 65536;  // of squares
  const T error = 2 * kSlack + kRounding * ShortPlace::kSteps * (farthest + 1);
  const T reach = ShortPlace::kSteps * 1.000001f + kRoot3 * error;
  const T squared = reach * reach * (1 / kUnit);
  return select(farthest < T(ShortPlace::kFarthest), select(squared < T(kMax), squared, T(kMax)), T(kMax));
}

/// The coordinates of particles in columns, two in the memory of a float. Behind each column there is room
/// for 32 more.
struct ShortPlaces {
  static constexpr int kBehind = 32;
  std::int16_t* x;
  std::int16_t* y;
  std::int16_t* z;

  ShortPlaces(Array<float>& memory, std::int64_t particles) {
    const std::int64_t height = heightFor(particles);
    memory.resizeDiscarding(floatsFor(particles));
    x = reinterpret_cast<std::int16_t*>(memory.data()), y = x + height, z = y + height;
  }

  static std::int64_t heightFor(std::int64_t particles) {
    return (particles + 2 * kBehind - 1) / kBehind * kBehind;
  }
  static std::int64_t floatsFor(std::int64_t particles) {
    return 3 * heightFor(particles) * std::int64_t{sizeof(std::int16_t)} / std::int64_t{sizeof(float)};
  }

  ShortPlace operator[](std::int64_t i) const { return {x[i], y[i], z[i]}; }
};

inline void writeShort(std::int16_t* to, std::int64_t i, float steps) {
  to[i] = static_cast<std::int16_t>(static_cast<std::int32_t>(ShortPlace::inRange(steps)));
}
#ifdef WEIR_HAS_EIGHT
inline void writeShort(std::int16_t* to, Eight i, const Lanes& steps) {
  using Shorts = std::int16_t __attribute__((vector_size(16)));
  using Anywhere __attribute__((vector_size(16), aligned(2), may_alias)) = std::int16_t;
  const auto whole = __builtin_convertvector(ShortPlace::inRange(steps).v, LaneInts::Vector);
  *reinterpret_cast<Anywhere*>(to + i.first) = __builtin_convertvector(whole, Shorts);
}
#endif

/// `Index` is one or eight.
template <class Index, class Position>
void writeShort(const ShortPlaces& places, Index i, const Position& p, float inverseCellSize) {
  const float scale = ShortPlace::kSteps * inverseCellSize;
  writeShort(places.x, i, scale * p.x);
  writeShort(places.y, i, scale * p.y);
  writeShort(places.z, i, scale * p.z);
}

struct FillShortPlaces {
  ArrayView<const Vec3f> positions;
  float inverseCellSize;
  ShortPlaces places;

  template <class Index>
  void operator()(Index i) const {
    writeShort(places, i, read(positions, i), inverseCellSize);
  }
};

/// The same in the order of owned particles and a halo.
struct FillMergedPlaces {
  ArrayView<const Vec3f> positions;
  float inverseCellSize;
  ShortPlaces places;
  MergedOrder order;

  void operator()(std::int64_t i) const {
    writeShort(places, i, positions[order.particles[i]], inverseCellSize);
  }
#ifdef WEIR_HAS_EIGHT
  void operator()(Eight i) const {
    writeShort(places, i, gatherLanes(positions.data, order.particles + i.first), inverseCellSize);
  }
#endif
};

/// Bit k tells whether the squared difference of p from place k of 64, in units of 2¹⁶ and rounded down for
/// each direction, is at most `reach`. The columns stand at multiples of 32 bytes.
inline std::uint64_t mayBeNear(const std::int16_t* x, const std::int16_t* y, const std::int16_t* z,
                               const ShortPlace& p, int reach) {
#if defined(__AVX2__)
  const __m256i px = _mm256_set1_epi16(p.x), py = _mm256_set1_epi16(p.y), pz = _mm256_set1_epi16(p.z);
  const __m256i max = _mm256_set1_epi16(static_cast<std::int16_t>(reach));
  const auto beyond = [&](int k) {
    const auto squared = [k](const std::int16_t* column, __m256i own) {
      const __m256i d =
          _mm256_sub_epi16(own, _mm256_load_si256(reinterpret_cast<const __m256i*>(column + k)));
      return _mm256_mulhi_epi16(d, d);
    };
    const __m256i sum = _mm256_adds_epi16(_mm256_adds_epi16(squared(x, px), squared(y, py)), squared(z, pz));
    return _mm256_cmpgt_epi16(sum, max);
  };
  const auto bits = [&](int k) {
    // By halves of registers.
    const __m256i packed = _mm256_packs_epi16(beyond(k), beyond(k + 16));
    return ~static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_permute4x64_epi64(packed, 0b11'01'10'00)));
  };
  return bits(0) | std::uint64_t{bits(32)} << 32;
#elif defined(__SSE2__)
  const __m128i px = _mm_set1_epi16(p.x), py = _mm_set1_epi16(p.y), pz = _mm_set1_epi16(p.z);
  const __m128i max = _mm_set1_epi16(static_cast<std::int16_t>(reach));
  const auto beyond = [&](int k) {
    const auto squared = [k](const std::int16_t* column, __m128i own) {
      const __m128i d = _mm_sub_epi16(own, _mm_load_si128(reinterpret_cast<const __m128i*>(column + k)));
      return _mm_mulhi_epi16(d, d);
    };
    return _mm_cmpgt_epi16(_mm_adds_epi16(_mm_adds_epi16(squared(x, px), squared(y, py)), squared(z, pz)),
                           max);
  };
  std::uint64_t bits = 0;
  for (int k = 0; k < 64; k += 16)
    bits |= static_cast<std::uint64_t>(_mm_movemask_epi8(_mm_packs_epi16(beyond(k), beyond(k + 8)))) << k;
  return ~bits;
#else
  std::uint64_t bits = 0;
  for (int k = 0; k < 64; ++k) {
    const auto squared = [k](const std::int16_t* column, int own) {
      const int d = static_cast<std::int16_t>(column[k] - own);
      return d * d >> 16;
    };
    const int sum = std::min(squared(x, p.x) + squared(y, p.y) + squared(z, p.z), 32767);
    bits |= static_cast<std::uint64_t>(sum <= reach) << k;
  }
  return bits;
#endif
}

/// The number of the lowest bit that is set, or 64. Without a branch, which compilers make of the function of
/// the standard library, to be guessed wrong for each particle.
inline std::uint64_t lowestBit(std::uint64_t bits) {
#ifdef __BMI__
  return _tzcnt_u64(bits);
#else
  return static_cast<std::uint64_t>(std::countr_zero(bits));
#endif
}

/// Places [begin, end) of sorted particles.
struct PlaceRange {
  int begin, end;
};

/// Those who may be near the particles of a few cells.
class Candidates {
 public:
  static constexpr int kMax = 1024;
  static constexpr unsigned kNone = 1u << 30;  // beyond all

  int size() const { return size_; }
  void clear() { size_ = 0; }

  /// There must be room for all. Returns what is between the place of a particle of the range and its place
  /// here.
  template <class Order = InPlace>
  int add(const ShortPlaces& from, const PlaceRange& range, const Order& order = {}) {
    const int shift = size_ - range.begin;
    // Nearly always one turn; of an empty range, too, because a wrong guess costs more.
    int j = range.begin;
    do {
      const int at = j + shift;
      copy(from.x + j, x_ + at);
      copy(from.y + j, y_ + at);
      copy(from.z + j, z_ + at);
      order.particlesAt(j).store(index_ + at);
      order.particlesAt(j + kEight).store(index_ + at + kEight);
      j += kInTurn;
    } while (j < range.end);
    size_ = range.end + shift;
    return shift;
  }

  /// After the last.
  void close() {
    lastBase_ = static_cast<int>(static_cast<unsigned>(size_ - 1) / kTogether * kTogether);
    index_[lastBase_ + kTogether] = index_[0];
    lastBits_ = ~std::uint64_t{0} >> (lastBase_ + kTogether - size_);
  }

  /// Writes those that may be near a particle at p, but for itself, to each eighth place of `list`, behind
  /// the first `found` ones, and up to kWrittenBehind more. The particle is the candidate `own`, or none of
  /// them. Returns how many there are then; nothing is written of those that would be more than `max`.
  int near(const ShortPlace& p, int reach, unsigned own, int* list, int found, int max) const {
    const std::uint64_t ownBit = std::uint64_t{1} << own % kTogether;
    const int ownBase = static_cast<int>(own - own % kTogether), last = lastBase_;
    const int* index = index_;
    for (int base = 0;; base += kTogether, index += kTogether) {
      std::uint64_t bits = mayBeNear(x_ + base, y_ + base, z_ + base, p, reach);
      bits &= base == last ? lastBits_ : ~std::uint64_t{0};
      bits &= ~(base == ownBase ? ownBit : 0);
      int* to = list + std::int64_t{found} * kEight;
      found += std::popcount(bits);
      if (found > max) break;
      // Mostly one turn, too. When no bit is left, it is the first index of the next 64.
      do {
        for (int k = 0; k < kWrittenBehind; ++k, to += kEight) {
          *to = index[lowestBit(bits)];
          bits &= bits - 1;
        }
      } while (bits != 0);
      if (base == last) break;
    }
    return found;
  }

  static constexpr int kWrittenBehind = 6;

 private:
  static constexpr int kInTurn = 16;
  static constexpr int kTogether = 64;

  using Shorts __attribute__((vector_size(32), aligned(2), may_alias)) = std::int16_t;
  static_assert(sizeof(Shorts) == kInTurn * sizeof(std::int16_t));
  static void copy(const std::int16_t* from, std::int16_t* to) {
    *reinterpret_cast<Shorts*>(to) = *reinterpret_cast<const Shorts*>(from);
  }

  int size_ = 0;
  // Of the last 64: where they begin, and which are there.
  int lastBase_ = 0;
  std::uint64_t lastBits_ = 0;
  // With room for a turn more.
  alignas(32) std::int16_t x_[kMax + kTogether] = {};
  alignas(32) std::int16_t y_[kMax + kTogether] = {};
  alignas(32) std::int16_t z_[kMax + kTogether] = {};
  alignas(32) int index_[kMax + kTogether] = {};
};

}  // namespace weir::detail

#endif
