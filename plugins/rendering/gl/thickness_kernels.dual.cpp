#include "plugins/rendering/gl/thickness_kernels.h"

#include "framework/compute/atomics.h"
#include "framework/compute/parallel.h"
#include "plugins/rendering/gl/splat_shapes.h"

namespace weir::rendering::gl {

namespace {

struct AddThickness {
  ArrayView<const SplatSphere> spheres;
  float chord;
  Shares shares;
  ThicknessView view;
  LiquidBetween between;
  ArrayView<std::uint32_t> sums;

  WEIR_HD float clip(int row, const Vec3f& p) const { return dot(view.rows[row], p) + view.moved[row]; }

  /// The part of a particle's foam that is seen at a texel.
  WEIR_HD float seen(int column, int row, float along, float radius) const {
    if (between.front.size == 0) return 1;
    const int x = shading::texelUnder(column, view.width, between.width);
    const int y = shading::texelUnder(row, view.height, between.height);
    const float depth = std::bit_cast<float>(between.front[std::int64_t{y} * between.width + x]);
    return shading::foamSeen(along, shading::distanceOf(depth, between.projection),
                             between.depthOfFoam * radius);
  }

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = shares.sphere(k);
    if (i >= shares.spheres) return;
    const SplatSphere p = spheres[i];
    if (!(p.radius > 0)) return;
    const float foam = std::bit_cast<float>(p.color);
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
    const float spread = radius / drawn, chordOfAll = chord / view.unit;
    for (int row = low + shares.part(k); row <= high; row += shares.parts) {
      const float v = (float(row) + 0.5f - middleY) / drawn;
      for (int column = left; column <= right; ++column) {
        const float u = (float(column) + 0.5f - middleX) / drawn;
        const float rest = 1 - (u * u + v * v);
        if (rest < 0) continue;
        const std::int64_t texel = std::int64_t{row} * view.width + column;
        if (between.background.size > 0 && along > between.background[texel]) continue;
        const float way = shading::wayThrough(rest, chordOfAll, spread);
        std::uint32_t* sum = sums.data + 2 * texel;
        atomicAdd(sum, static_cast<std::uint32_t>(way + 0.5f));
        if (foam > 0)
          atomicAdd(sum + 1,
                    static_cast<std::uint32_t>(way * foam * seen(column, row, along, p.radius) + 0.5f));
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
void addLiquid(Backend& device, ArrayView<const SplatSphere> spheres, float chord, const ThicknessView& view,
               const LiquidBetween& between, ArrayView<std::uint32_t> sums) {
  const Shares shares(spheres.size);
  parallelFor(device, "thickness", shares.count(), AddThickness{spheres, chord, shares, view, between, sums});
}

template <class Backend>
void thicknessOf(Backend& device, ArrayView<const std::uint32_t> sums, float unit,
                 ArrayView<Vec2f> thickness) {
  parallelFor(device, "thickness in metres", thickness.size, ToMetres{sums, unit, thickness});
}

template void addLiquid(ThisBackend&, ArrayView<const SplatSphere>, float, const ThicknessView&,
                        const LiquidBetween&, ArrayView<std::uint32_t>);
template void thicknessOf(ThisBackend&, ArrayView<const std::uint32_t>, float, ArrayView<Vec2f>);

}  // namespace weir::rendering::gl
