// What is seen at the samples of a picture, for kernels that work on whole pictures: the nearest sphere as
// splat_kernels.h found it, the ground, or the background.
#pragma once

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

struct SeenSamples {
  gl::SplatCamera camera;  ///< in samples
  ArrayView<const SplatSphere> spheres;
  ArrayView<const std::uint64_t> nearest;  ///< see gl::splatDepths; the ground is gl::kNoSphere
  ShadedGround ground;

  WEIR_HD SeenRow row(const Ints& x, int y) const {
    const std::uint64_t* line = nearest.data + std::int64_t{y} * camera.width;
    return {gatherHalf(line, x, true), gatherHalf(line, x, false)};
  }

  /// The ray through the middle of a sample, of length 1 along the camera's axis.
  WEIR_HD Numbers3 ray(const Number& x, const Number& y) const {
    return {((x + 0.5f) * (2.0f / static_cast<float>(camera.width)) - 1) * camera.tangent.x,
            ((y + 0.5f) * (2.0f / static_cast<float>(camera.height)) - 1) * camera.tangent.y, Number(-1.0f)};
  }
  WEIR_HD Number distanceAt(const Number& depth) const {
    return camera.projection.w / (2 * depth - 1 + camera.projection.z);
  }

  /// Of samples that see spheres or the ground.
  WEIR_HD Numbers3 normal(const SeenRow& seen, const Numbers3& ray) const {
    const Mask level = seen.ground();
    const Numbers3 up = allOf(ground.up);
    if (!any(notSo(level))) return up;
    const Ints first = firstWords(seen);
    const Numbers3 place{word(first, 0), word(first, 1), word(first, 2)};
    const Number radius = word(first, 3);
    const auto turned = [&](int i) {
      return dot(allOf(camera.rows[i]), place) + (i == 0   ? camera.moved.x
                                                  : i == 1 ? camera.moved.y
                                                           : camera.moved.z);
    };
    const Numbers3 center{turned(0), turned(1), turned(2)};
    const gl::Hit<Number> hit(ray, center, radius);
    return selectAll(level, up, unit(ray * hit.distance - center));
  }

  /// The colours of spheres, as in SplatSphere.
  WEIR_HD Ints sphereColors(const SeenRow& seen) const {
    return gather(reinterpret_cast<const std::uint32_t*>(spheres.data), firstWords(seen) + 4);
  }

 private:
  static constexpr int kWords = 5;  // of a SplatSphere
  static_assert(sizeof(SplatSphere) == kWords * sizeof(float));

  /// Where the spheres begin; that of the first sphere where none is seen.
  WEIR_HD Ints firstWords(const SeenRow& seen) const {
    const Ints sphere = static_cast<int>(gl::kNoSphere) - 1 - seen.numbers;
    return selectInts(seen.ground(), allInts(0), sphere) * kWords;
  }
  WEIR_HD Number word(const Ints& first, int i) const {
    return gather(reinterpret_cast<const float*>(spheres.data), first + i);
  }
};

}  // namespace weir::rendering
