#include "plugins/rendering/gl/water_kernels.h"

#include "framework/compute/atomic_add.h"
#include "framework/compute/atomic_min.h"
#include "framework/compute/parallel.h"
#include "plugins/rendering/gl/splat_shapes.h"

namespace weir::rendering::gl {

namespace {

struct ClearDepth {
  ArrayView<std::uint32_t> depthBits;
  WEIR_HD void operator()(std::int64_t k) const { depthBits[k] = kOneBits; }
};

struct OfferWaterDepth {
  ArrayView<const WaterParticle> particles;
  Shares shares;
  SplatCamera camera;
  ArrayView<std::uint32_t> depthBits;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = shares.sphere(k);
    if (i >= shares.spheres) return;
    const float radius = particles[i].radius, inset = particles[i].inset;
    const Vec3f center = camera.point(particles[i].center);
    const float along = -center.z;
    if (along + radius < camera.near) return;  // behind the camera
    Samples x{0, camera.width - 1}, y{0, camera.height - 1};
    if (along - radius > camera.near) {  // otherwise it may fill the picture
      x = touched(center.x, along, radius, camera.tangent.x, camera.width);
      y = touched(center.y, along, radius, camera.tangent.y, camera.height);
    }
    constexpr float kNearer = 0.9999f;  // for rounding
    const float front = kNearer * (along - radius + inset);
    const std::uint32_t best = bitsOf(camera.depthAt(front > camera.near ? front : camera.near));
    for (int row = y.first + shares.part(k); row <= y.last; row += shares.parts) {
      std::uint32_t* line = depthBits.data + std::int64_t{row} * camera.width;
      for (int column = x.first; column <= x.last; ++column) {
        if (currentLeast(line + column) < best) continue;  // all of it is hidden there
        const Hit<float> hit(camera.ray(column, row), center, radius);
        if (hit.rest < 0 || hit.distance < camera.near) continue;
        atomicMin(line + column, bitsOf(camera.depthAt(hit.distance + inset)));
      }
    }
  }
};

struct OfferWaterSunDepth {
  ArrayView<const WaterParticle> particles;
  Shares shares;
  SplatSun sun;
  ArrayView<std::uint32_t> depthBits;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = shares.sphere(k);
    if (i >= shares.spheres) return;
    const Vec3f center = sun.point(particles[i].center);
    const float radius = particles[i].radius / sun.halfSize;  // in clip space
    const Samples x = Samples::between(center.x - radius, center.x + radius, sun.resolution);
    const Samples y = Samples::between(center.y - radius, center.y + radius, sun.resolution);
    const float texel = 2.0f / float(sun.resolution);
    const float thick = particles[i].radius * sun.zToDepth;
    const std::uint32_t best = bitsOf(0.5f + 0.5f * (center.z - thick));
    for (int row = y.first + shares.part(k); row <= y.last; row += shares.parts) {
      const float v = ((float(row) + 0.5f) * texel - 1 - center.y) / radius;
      std::uint32_t* line = depthBits.data + std::int64_t{row} * sun.resolution;
      for (int column = x.first; column <= x.last; ++column) {
        if (currentLeast(line + column) < best) continue;
        const float u = ((float(column) + 0.5f) * texel - 1 - center.x) / radius;
        const float rest = 1 - (u * u + v * v);
        if (rest < 0) continue;
        atomicMin(line + column, bitsOf(0.5f + 0.5f * (center.z - thick * std::sqrt(rest))));
      }
    }
  }
};

struct ClearSums {
  ArrayView<std::uint32_t> sums;
  WEIR_HD void operator()(std::int64_t k) const { sums[k] = 0; }
};

struct AddThickness {
  ArrayView<const WaterParticle> particles;
  Shares shares;
  ThicknessView view;
  LiquidBetween between;
  ArrayView<std::uint32_t> sums;

  WEIR_HD float clip(int row, const Vec3f& p) const { return dot(view.rows[row], p) + view.moved[row]; }

  /// The part of a particle's foam that is seen at a texel.
  WEIR_HD float seen(int column, int row, float along, float radius) const {
    if (between.front.size == 0) return 1;
    const int x = int((float(column) + 0.5f) * (float(between.width) / float(view.width)));
    const int y = int((float(row) + 0.5f) * (float(between.height) / float(view.height)));
    const float depth = std::bit_cast<float>(between.front[std::int64_t{y} * between.width + x]);
    const float distance = between.projection.w / (2 * depth - 1 + between.projection.z);
    const float part = 1 - (along - distance) / (between.depthOfFoam * radius);
    return part > 0 ? (part < 1 ? part : 1.0f) : 0.0f;
  }

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = shares.sphere(k);
    if (i >= shares.spheres) return;
    const WaterParticle p = particles[i];
    const float along = clip(3, p.center);
    if (along < view.near) return;
    const float radius = p.radius * view.texels / along;
    const float drawn = radius > 1 ? radius : 1.0f;
    const float middleX = (0.5f + 0.5f * clip(0, p.center) / along) * float(view.width);
    const float middleY = (0.5f + 0.5f * clip(1, p.center) / along) * float(view.height);
    const int left = clampToInt(std::ceil(middleX - drawn - 0.5f), 0, view.width);
    const int right = clampToInt(std::floor(middleX + drawn - 0.5f), -1, view.width - 1);
    const int low = clampToInt(std::ceil(middleY - drawn - 0.5f), 0, view.height);
    const int high = clampToInt(std::floor(middleY + drawn - 0.5f), -1, view.height - 1);
    const float spread = radius / drawn;
    const float middle = p.chord * spread * spread / view.unit;
    for (int row = low + shares.part(k); row <= high; row += shares.parts) {
      const float v = (float(row) + 0.5f - middleY) / drawn;
      for (int column = left; column <= right; ++column) {
        const float u = (float(column) + 0.5f - middleX) / drawn;
        const float rest = 1 - (u * u + v * v);
        if (rest < 0) continue;
        const std::int64_t texel = std::int64_t{row} * view.width + column;
        if (between.background.size > 0 && along > between.background[texel]) continue;
        const float chord = middle * std::sqrt(rest);
        std::uint32_t* sum = sums.data + 2 * texel;
        atomicAdd(sum, static_cast<std::uint32_t>(chord + 0.5f));
        if (p.foam > 0)
          atomicAdd(sum + 1,
                    static_cast<std::uint32_t>(chord * p.foam * seen(column, row, along, p.radius) + 0.5f));
      }
    }
  }
};

struct ToMetres {
  ArrayView<const std::uint32_t> sums;
  float unit;
  ArrayView<Vec2f> thickness;
  WEIR_HD void operator()(std::int64_t k) const {
    thickness[k] = {unit * float(sums[2 * k]), unit * float(sums[2 * k + 1])};
  }
};

}  // namespace

template <class Backend>
void splatWaterDepth(Backend& device, ArrayView<const WaterParticle> particles, const SplatCamera& camera,
                     ArrayView<std::uint32_t> depthBits) {
  parallelFor(device, "clear water", depthBits.size, ClearDepth{depthBits});
  const Shares shares(particles.size);
  parallelFor(device, "water depth", shares.count(), OfferWaterDepth{particles, shares, camera, depthBits});
}

template <class Backend>
void splatWaterSunDepth(Backend& device, ArrayView<const WaterParticle> particles, const SplatSun& sun,
                        ArrayView<std::uint32_t> depthBits) {
  parallelFor(device, "clear water", depthBits.size, ClearDepth{depthBits});
  const Shares shares(particles.size);
  parallelFor(device, "water from the sun", shares.count(),
              OfferWaterSunDepth{particles, shares, sun, depthBits});
}

template <class Backend>
void splatThickness(Backend& device, ArrayView<const WaterParticle> particles, const ThicknessView& view,
                    const LiquidBetween& between, ArrayView<std::uint32_t> sums, ArrayView<Vec2f> thickness) {
  parallelFor(device, "clear thickness", sums.size, ClearSums{sums});
  const Shares shares(particles.size);
  parallelFor(device, "thickness", shares.count(), AddThickness{particles, shares, view, between, sums});
  parallelFor(device, "thickness in metres", thickness.size, ToMetres{sums, view.unit, thickness});
}

template void splatWaterDepth(ThisBackend&, ArrayView<const WaterParticle>, const SplatCamera&,
                              ArrayView<std::uint32_t>);
template void splatWaterSunDepth(ThisBackend&, ArrayView<const WaterParticle>, const SplatSun&,
                                 ArrayView<std::uint32_t>);
template void splatThickness(ThisBackend&, ArrayView<const WaterParticle>, const ThicknessView&,
                             const LiquidBetween&, ArrayView<std::uint32_t>, ArrayView<Vec2f>);

}  // namespace weir::rendering::gl
