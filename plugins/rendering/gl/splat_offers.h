// Spheres offer their depths to the samples of a camera, or of the sun.
#pragma once

#include "plugins/rendering/gl/splat_kernels.h"
#include "plugins/rendering/gl/splat_rounds.h"

namespace weir::rendering::gl {

/// The samples that a sphere may cover, and the least depth that it may have there.
struct Reach {
  Samples x, y;
  float depth;
};

/// The bits of depths, alone or with the number of the sphere.
WEIR_HD inline void offerDepth(std::uint32_t* min, std::uint32_t depthBits, std::int64_t) {
  atomicMin(min, depthBits);
}
WEIR_HD inline void offerDepth(std::uint64_t* min, std::uint32_t depthBits, std::int64_t sphere) {
  atomicMin(min, std::uint64_t{depthBits} << 32 |
                     std::uint64_t{kNoSphere - 1 - static_cast<std::uint32_t>(sphere)});
}

template <class Least>
WEIR_HD void offerDepths(Least* first, const Mask& where, const Number& depths, std::int64_t sphere) {
  unsigned left = bitsOfMask(where);
  for (int l = 0; left != 0; ++l, left >>= 1)
    if ((left & 1u) != 0) offerDepth(first + l, laneOf(bitsOfNumbers(depths), l), sphere);
}

/// Called with a sphere's number, a part of its rows, and how many parts there are.
template <class Least>
struct OfferToCamera {
  ArrayView<const SplatSphere> spheres;
  SplatCamera camera;
  float inset;  ///< m
  ArrayView<Least> min;

  WEIR_HD float distanceTo(const SphereGroup& group) const {
    return -camera.view.point(group.center).z - group.radius;
  }

  /// In camera space.
  WEIR_HD Reach reach(const Vec3f& center, float radius) const {
    constexpr float kNearer = 0.9999f;  // for rounding
    const float along = -center.z, front = kNearer * (along - radius + inset);
    Reach found{{0, camera.width - 1},
                {0, camera.height - 1},
                positivePart(camera.depthAt(front > camera.near ? front : camera.near))};
    if (along - radius > camera.near) {  // otherwise it may fill the picture
      found.x = touched(center.x, along, radius, camera.tangent.x, camera.width);
      found.y = touched(center.y, along, radius, camera.tangent.y, camera.height);
    }
    return found;
  }

  WEIR_HD bool hidden(const SphereGroup& group, const FarthestTiles& tiles) const {
    const Vec3f center = camera.view.point(group.center);
    if (!(group.radius > 0) || group.radius - center.z < camera.near) return true;
    const Reach found = reach(center, group.radius);
    return tiles.hide(found.x, found.y, found.depth);
  }

  WEIR_HD void operator()(std::int64_t i, int part, int parts, const FarthestTiles& tiles) const {
    const float radius = spheres[i].radius;
    const Vec3f center = camera.view.point(spheres[i].center);
    if (!(radius > 0) || radius - center.z < camera.near) return;  // nowhere, or behind the camera
    const Reach found = reach(center, radius);
    if (tiles.hide(found.x, found.y, found.depth)) return;
    for (int row = found.y.first + part; row <= found.y.last; row += parts)
      offerRow(row, found, i, center, radius);
  }

  WEIR_HD void offerRow(int row, const Reach& found, std::int64_t i, const Vec3f& center,
                        float radius) const {
    Least* line = min.data + std::int64_t{row} * camera.width;
    for (int column = found.x.first; column <= found.x.last; column += kPixels) {
      const Number now = depthsOfRow(line, column, camera.width);
      const Ints columns = intsFrom(column);
      const Mask open = !(now < Number(found.depth)) & below(columns, found.x.last + 1);
      if (!any(open)) continue;  // all of it is hidden there
      const Numbers3 ray = camera.ray(toNumbers(columns), Number(float(row)));
      Number rest;
      const Number distance = shading::distanceOfSphere(ray, allOf(center), Number(radius), rest);
      const Number depth = positivePart(camera.depthAt(distance + inset));
      const Mask missed = (rest < Number(0.0f)) | (distance < Number(camera.near)) | (now < depth);
      offerDepths(line + column, open & !missed, depth, i);
    }
  }
};

struct OfferToSun {
  ArrayView<const SplatSphere> spheres;
  SplatSun sun;
  ArrayView<std::uint32_t> min;

  WEIR_HD float distanceTo(const SphereGroup& group) const {
    return sun.toClip.point(group.center).z - group.radius * sun.zToDepth;
  }

  /// In clip space but for the radius, m.
  WEIR_HD Reach reach(const Vec3f& center, float radius) const {
    const float wide = radius / sun.halfSize;
    return {Samples::between(center.x - wide, center.x + wide, sun.resolution),
            Samples::between(center.y - wide, center.y + wide, sun.resolution),
            positivePart(0.5f + 0.5f * (center.z - radius * sun.zToDepth))};
  }

  WEIR_HD bool hidden(const SphereGroup& group, const FarthestTiles& tiles) const {
    if (!(group.radius > 0)) return true;
    const Reach found = reach(sun.toClip.point(group.center), group.radius);
    return tiles.hide(found.x, found.y, found.depth);
  }

  WEIR_HD void operator()(std::int64_t i, int part, int parts, const FarthestTiles& tiles) const {
    if (!(spheres[i].radius > 0)) return;
    const Vec3f center = sun.toClip.point(spheres[i].center);
    const Reach found = reach(center, spheres[i].radius);
    if (tiles.hide(found.x, found.y, found.depth)) return;
    for (int row = found.y.first + part; row <= found.y.last; row += parts)
      offerRow(row, found, center, spheres[i].radius);
  }

  WEIR_HD void offerRow(int row, const Reach& found, const Vec3f& center, float metres) const {
    const float radius = metres / sun.halfSize, thick = metres * sun.zToDepth;
    const float texel = 2.0f / float(sun.resolution);
    const float v = ((float(row) + 0.5f) * texel - 1 - center.y) / radius;
    std::uint32_t* line = min.data + std::int64_t{row} * sun.resolution;
    for (int column = found.x.first; column <= found.x.last; column += kPixels) {
      const Number now = depthsOfRow(line, column, sun.resolution);
      const Ints columns = intsFrom(column);
      const Mask open = (!(now < Number(found.depth))) & below(columns, found.x.last + 1);
      if (!any(open)) continue;
      const Number u = ((toNumbers(columns) + 0.5f) * texel - 1 - center.x) / radius;
      const Number rest = 1 - (u * u + v * v);
      const Number depth =
          positivePart(shading::depthFromSun(positivePart(rest), Number(center.z), Number(thick)));
      offerDepths(line + column, open & (depth < now) & (!(rest < Number(0.0f))), depth, 0);
    }
  }
};

}  // namespace weir::rendering::gl
