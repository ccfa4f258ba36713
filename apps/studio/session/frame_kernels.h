// From attributes of particles to what viewers get of them, on the device where they are.
#pragma once

#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace weir::studio {

/// Which particles; without indices all of them.
struct ChosenParticles {
  ArrayView<const int> indices;
  std::int64_t count = 0;

  WEIR_HD std::int64_t operator[](std::int64_t i) const { return indices.data != nullptr ? indices[i] : i; }
};

/// Where finite numbers lie, in each direction; low > high if there are none.
template <class T>
struct Range {
  T low, high;
};

/// The numbers of the particles whose id is a multiple of `every`, in order, and in *kept (device memory) how
/// many these are.
template <class Backend>
void chooseEvery(Backend& device, ArrayView<const std::int64_t> ids, std::int64_t every,
                 ArrayView<int> indices, int* kept);

/// to[i] = from[particles[i]]
template <class Backend>
void takeIds(Backend& device, ArrayView<const std::int64_t> from, const ChosenParticles& particles,
             ArrayView<std::int64_t> to);

/// Of numbers, or of the lengths of vectors and norms of matrices; in device memory.
template <class Backend, class T>
void rangeOf(Backend& device, ArrayView<const T> values, const ChosenParticles& particles,
             Range<float>* range);
template <class Backend>
void boundsOf(Backend& device, ArrayView<const Vec3f> points, const ChosenParticles& particles,
              Range<Vec3f>* bounds);

/// In 16 bits each: low + (high - low)·u/65535, off by at most half of (high - low)/65535. What is no number
/// is 0, and so is all where the range has no finite size.
template <class Backend, class T>
void quantize(Backend& device, ArrayView<const T> values, const ChosenParticles& particles,
              const Range<float>* range, ArrayView<std::uint16_t> to);
/// x, y, z of each.
template <class Backend>
void quantizePoints(Backend& device, ArrayView<const Vec3f> points, const ChosenParticles& particles,
                    const Range<Vec3f>* bounds, ArrayView<std::uint16_t> to);

}  // namespace weir::studio
