// From the attributes of particles to what a picture needs of them, on a compute device.
#pragma once

#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"
#include "nodes/white_water/white_particles.h"

namespace weir::rendering {

/// One number for each element: the lengths of vectors, Frobenius norms of matrices, whole numbers as floats.
template <class Backend, class T>
void findNumbers(Backend& device, ArrayView<const T> elements, ArrayView<float> numbers);

/// How far each value is on its way from `ends.x` to `ends.y`, within [0, 1]; 0 for what is not a number.
template <class Backend>
void findParts(Backend& device, ArrayView<const float> values, const Vec2f& ends, ArrayView<float> parts);

/// The part of its radius that white water is drawn with. Drops are the smallest, and bubbles are faint.
WEIR_HD constexpr float shownShareOf(WhiteKind kind) {
  return kind == WhiteKind::kFoam ? 0.5f : 0.3f;
}

/// The radii, m, that white water is drawn with: of stored radii r with the mean m and of kinds (WhiteKind),
/// or of spray where there are none, shownShareOf(kind) m (r/m)^2. Smaller than they are, as what is seen of
/// a particle stands for many; the second power makes of a range, such as WhiteWater's, many small ones and
/// few large ones.
template <class Backend>
void findWhiteRadii(Backend& device, ArrayView<const float> stored, ArrayView<const int> kinds, float mean,
                    ArrayView<float> radii);

/// The least and the largest of all finite values, in device memory; {inf, -inf} if there is none.
template <class Backend>
void rangeOf(Backend& device, ArrayView<const float> values, Vec2f* range);

/// The box around all finite positions, in device memory.
template <class Backend>
void boxOf(Backend& device, ArrayView<const Vec3f> positions, Aabb* box);

struct PlacesSum {
  Vec3d sum;
  double count = 0;
};
/// Of all finite places, in device memory.
template <class Backend>
void sumOf(Backend& device, ArrayView<const Vec3f> places, PlacesSum* sum);

/// Shows what is on the side of a plane where its normal does not point, or no farther from it than half the
/// thickness.
struct Cut {
  Vec3f point, normal;       ///< the normal has length 1
  float halfThickness = -1;  ///< m; below 0: there is none

  WEIR_HD bool shows(const Vec3f& place) const {
    const float above = dot(place - point, normal);
    return halfThickness < 0 ? above <= 0 : (above < 0 ? -above : above) <= halfThickness;
  }
};

/// The numbers of those places that all cuts show, in order, and in *kept (device memory) how many these are.
template <class Backend>
void chooseShown(Backend& device, ArrayView<const Vec3f> places, ArrayView<const Cut> cuts,
                 ArrayView<int> chosen, int* kept);

/// to[i] = from[chosen[i]]
template <class Backend, class T>
void take(Backend& device, ArrayView<const int> chosen, ArrayView<const T> from, ArrayView<T> to);

}  // namespace weir::rendering
