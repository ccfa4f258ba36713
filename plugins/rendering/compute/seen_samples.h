// What is seen at the samples of a picture, for kernels that work on whole pictures: the nearest sphere as
// splat_kernels.h found it, the ground, or the background.
#pragma once

#include <cstddef>

#include "plugins/rendering/compute/pixel_lanes.h"
#include "plugins/rendering/gl/splat_kernels.h"
#include "plugins/rendering/gl/splat_shapes.h"

namespace weir::rendering {

/// The ground: a level disc, seen from above only. In camera space.
struct ShadedGround {
  bool visible = false;
  Vec3f middle, up;
  float radius = 0;  ///< m
  Vec3f color;       ///< linear
};

/// Samples of one row.
struct SeenRow {
  Ints depthBits, numbers;  ///< the two halves of what SeenSamples::nearest holds

  WEIR_HD Number depth() const { return numbersOfBits(depthBits); }
  /// Where there is a surface.
  WEIR_HD Mask something() const { return depth() < Number(1.0f); }
  WEIR_HD Mask ground() const { return equal(numbers, static_cast<int>(gl::kNoSphere)); }
};

#ifdef WEIR_HAS_LANES
/// What weir::detail::transposed makes columns of: centre and radius.
inline weir::detail::HalfLanes rowOf(const SplatSphere& sphere) {
  weir::detail::HalfLanes row;
  static_assert(offsetof(SplatSphere, radius) == 3 * sizeof(float));
  __builtin_memcpy(&row, &sphere, sizeof row);
  return row;
}
#endif

struct SeenSamples {
  gl::SplatCamera camera;  ///< in samples
  ArrayView<const SplatSphere> spheres;
  ArrayView<const std::uint64_t> nearest;  ///< see gl::splatDepths; the ground is gl::kNoSphere
  ShadedGround ground;

  WEIR_HD SeenRow row(const Ints& x, int y) const {
    SeenRow seen;
    const std::uint64_t* line = nearest.data + std::int64_t{y} * camera.width;
    gatherHalves(line, x, seen.numbers, seen.depthBits);
#ifdef WEIR_HAS_LANES
    constexpr int kAhead = 96;  // samples: the processor does not see by itself where gathers go
    __builtin_prefetch(line + laneOf(x, 0) + kAhead);
    __builtin_prefetch(line + laneOf(x, kPixels - 1) + kAhead);
#endif
    return seen;
  }

  /// The ray through the middle of a sample, of length 1 along the camera's axis.
  WEIR_HD Numbers3 ray(const Number& x, const Number& y) const {
    return camera.ray(x, y);
  }
  WEIR_HD Number distanceAt(const Number& depth) const {
    return shading::distanceOf(depth, camera.projection);
  }

  /// Of samples that see spheres or the ground.
  WEIR_HD Numbers3 normal(const SeenRow& seen, const Numbers3& ray) const {
    const Mask level = seen.ground();
    const Numbers3 up = allOf(ground.up);
    if (!any(!level)) return up;
    Number radius;
    const Numbers3 place = balls(seen, radius);
    const Numbers3 center = camera.view.point(place);
    Number rest;
    return select(level, up, unit(ray * shading::distanceOfSphere(ray, center, radius, rest) - center));
  }

  /// The colours of spheres, as in SplatSphere.
  WEIR_HD Ints sphereColors(const SeenRow& seen) const {
#ifdef WEIR_HAS_LANES
    // One by one: counted in words, the places of 430 million spheres and more are beyond an int.
    int index[kPixels];
    const Ints sphere = sphereOf(seen);
    __builtin_memcpy(index, &sphere, sizeof index);
    Ints colors;
    for (int l = 0; l < kPixels; ++l) colors[l] = static_cast<int>(spheres.data[index[l]].color);
    return colors;
#else
    return static_cast<int>(spheres[sphereOf(seen)].color);
#endif
  }

 private:
  /// The first one where none is seen.
  WEIR_HD static Ints sphereOf(const SeenRow& seen) {
    return selectInts(seen.ground(), allInts(0), static_cast<int>(gl::kNoSphere) - 1 - seen.numbers);
  }

  /// Centres and radii.
  WEIR_HD Numbers3 balls(const SeenRow& seen, Number& radius) const {
#ifdef WEIR_HAS_LANES
    int index[kPixels];
    const Ints sphere = sphereOf(seen);
    __builtin_memcpy(index, &sphere, sizeof index);
    const Vec4<Lanes> columns = weir::detail::transposed(spheres.data, index);
    radius = columns.w;
    return {columns.x, columns.y, columns.z};
#else
    const SplatSphere& sphere = spheres[sphereOf(seen)];
    radius = sphere.radius;
    return sphere.center;
#endif
  }
};

}  // namespace weir::rendering
