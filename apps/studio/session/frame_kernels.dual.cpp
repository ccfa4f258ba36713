#include "apps/studio/session/frame_kernels.h"

#include <limits>

#include "framework/compute/parallel.h"
#include "framework/particles/single_number.h"

namespace weir::studio {

namespace {

constexpr float kMax = std::numeric_limits<float>::max();

WEIR_HD bool isNumber(float value) {
  return value >= -kMax && value <= kMax;
}

WEIR_HD Range<float> rangeOfOne(float value) {
  return isNumber(value) ? Range<float>{value, value} : Range<float>{kMax, -kMax};
}

WEIR_HD Range<float> unite(const Range<float>& a, const Range<float>& b) {
  return {a.low < b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}

WEIR_HD std::uint16_t place(float value, float low, float high) {
  constexpr float kSteps = 65535;
  const float size = high - low;  // infinite where a simulation has diverged
  if (!(size > 0 && size <= kMax) || !isNumber(value)) return 0;
  return static_cast<std::uint16_t>(static_cast<int>((value - low) / size * kSteps + 0.5f));
}

struct IsEvery {
  ArrayView<const std::int64_t> ids;
  std::int64_t every;
  WEIR_HD bool operator()(std::int64_t i) const { return ids[i] % every == 0; }
};

struct Take {
  ArrayView<const std::int64_t> from;
  ChosenParticles particles;
  ArrayView<std::int64_t> to;
  WEIR_HD void operator()(std::int64_t i) const { to[i] = from[particles[i]]; }
};

template <class T>
struct RangeOfParticle {
  ArrayView<const T> values;
  ChosenParticles particles;
  WEIR_HD Range<float> operator()(std::int64_t i) const {
    return rangeOfOne(singleNumber(values[particles[i]]));
  }
};

struct UniteRanges {
  WEIR_HD Range<float> operator()(const Range<float>& a, const Range<float>& b) const { return unite(a, b); }
};

struct BoundsOfParticle {
  ArrayView<const Vec3f> points;
  ChosenParticles particles;
  WEIR_HD Range<Vec3f> operator()(std::int64_t i) const {
    const Vec3f p = points[particles[i]];
    const Range<float> x = rangeOfOne(p.x), y = rangeOfOne(p.y), z = rangeOfOne(p.z);
    return {{x.low, y.low, z.low}, {x.high, y.high, z.high}};
  }
};

struct UniteBounds {
  WEIR_HD Range<Vec3f> operator()(const Range<Vec3f>& a, const Range<Vec3f>& b) const {
    const Range<float> x = unite({a.low.x, a.high.x}, {b.low.x, b.high.x});
    const Range<float> y = unite({a.low.y, a.high.y}, {b.low.y, b.high.y});
    const Range<float> z = unite({a.low.z, a.high.z}, {b.low.z, b.high.z});
    return {{x.low, y.low, z.low}, {x.high, y.high, z.high}};
  }
};

template <class T>
struct Quantize {
  ArrayView<const T> values;
  ChosenParticles particles;
  const Range<float>* range;
  ArrayView<std::uint16_t> to;
  WEIR_HD void operator()(std::int64_t i) const {
    to[i] = place(singleNumber(values[particles[i]]), range->low, range->high);
  }
};

struct QuantizePoints {
  ArrayView<const Vec3f> points;
  ChosenParticles particles;
  const Range<Vec3f>* bounds;
  ArrayView<std::uint16_t> to;
  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = points[particles[i]], low = bounds->low, high = bounds->high;
    to[3 * i] = place(p.x, low.x, high.x);
    to[3 * i + 1] = place(p.y, low.y, high.y);
    to[3 * i + 2] = place(p.z, low.z, high.z);
  }
};

}  // namespace

template <class Backend>
void chooseEvery(Backend& device, ArrayView<const std::int64_t> ids, std::int64_t every,
                 ArrayView<int> indices, int* kept) {
  compact(device, "choose for viewers", ids.size, IsEvery{ids, every}, indices, kept);
}

template <class Backend>
void takeIds(Backend& device, ArrayView<const std::int64_t> from, const ChosenParticles& particles,
             ArrayView<std::int64_t> to) {
  parallelFor(device, "ids for viewers", particles.count, Take{from, particles, to});
}

template <class Backend, class T>
void rangeOf(Backend& device, ArrayView<const T> values, const ChosenParticles& particles,
             Range<float>* range) {
  reduce(device, "range for viewers", particles.count, Range<float>{kMax, -kMax},
         RangeOfParticle<T>{values, particles}, UniteRanges{}, range);
}

template <class Backend>
void boundsOf(Backend& device, ArrayView<const Vec3f> points, const ChosenParticles& particles,
              Range<Vec3f>* bounds) {
  constexpr Range<Vec3f> kNone{{kMax, kMax, kMax}, {-kMax, -kMax, -kMax}};
  reduce(device, "bounds for viewers", particles.count, kNone, BoundsOfParticle{points, particles},
         UniteBounds{}, bounds);
}

template <class Backend, class T>
void quantize(Backend& device, ArrayView<const T> values, const ChosenParticles& particles,
              const Range<float>* range, ArrayView<std::uint16_t> to) {
  parallelFor(device, "values for viewers", particles.count, Quantize<T>{values, particles, range, to});
}

template <class Backend>
void quantizePoints(Backend& device, ArrayView<const Vec3f> points, const ChosenParticles& particles,
                    const Range<Vec3f>* bounds, ArrayView<std::uint16_t> to) {
  parallelFor(device, "points for viewers", particles.count, QuantizePoints{points, particles, bounds, to});
}

template void chooseEvery(ThisBackend&, ArrayView<const std::int64_t>, std::int64_t, ArrayView<int>, int*);
template void takeIds(ThisBackend&, ArrayView<const std::int64_t>, const ChosenParticles&,
                      ArrayView<std::int64_t>);
template void rangeOf(ThisBackend&, ArrayView<const float>, const ChosenParticles&, Range<float>*);
template void rangeOf(ThisBackend&, ArrayView<const int>, const ChosenParticles&, Range<float>*);
template void rangeOf(ThisBackend&, ArrayView<const std::int64_t>, const ChosenParticles&, Range<float>*);
template void rangeOf(ThisBackend&, ArrayView<const Vec3f>, const ChosenParticles&, Range<float>*);
template void rangeOf(ThisBackend&, ArrayView<const Mat3f>, const ChosenParticles&, Range<float>*);
template void boundsOf(ThisBackend&, ArrayView<const Vec3f>, const ChosenParticles&, Range<Vec3f>*);
template void quantize(ThisBackend&, ArrayView<const float>, const ChosenParticles&, const Range<float>*,
                       ArrayView<std::uint16_t>);
template void quantize(ThisBackend&, ArrayView<const int>, const ChosenParticles&, const Range<float>*,
                       ArrayView<std::uint16_t>);
template void quantize(ThisBackend&, ArrayView<const std::int64_t>, const ChosenParticles&,
                       const Range<float>*, ArrayView<std::uint16_t>);
template void quantize(ThisBackend&, ArrayView<const Vec3f>, const ChosenParticles&, const Range<float>*,
                       ArrayView<std::uint16_t>);
template void quantize(ThisBackend&, ArrayView<const Mat3f>, const ChosenParticles&, const Range<float>*,
                       ArrayView<std::uint16_t>);
template void quantizePoints(ThisBackend&, ArrayView<const Vec3f>, const ChosenParticles&,
                             const Range<Vec3f>*, ArrayView<std::uint16_t>);

}  // namespace weir::studio
