#include "plugins/rendering/gl/splat_kernels.h"

#include <bit>
#include <cmath>

#include "framework/compute/parallel.h"
#include "plugins/rendering/gl/splat_rows.h"

namespace weir::rendering::gl {

namespace {

constexpr std::uint64_t kNobody = std::uint64_t{kOneBits} << 32 | kNoSphere;

struct OfferDepths {
  ArrayView<const SplatSphere> spheres;
  Shares shares;
  SplatCamera camera;
  ArrayView<std::uint64_t> nearest;
  std::int64_t first;  // share
  FarthestTiles tiles;

  WEIR_HD void operator()(std::int64_t later) const {
    const std::int64_t k = first + later, i = shares.sphere(k);
    if (i >= shares.spheres) return;
    const float radius = spheres[i].radius;
    if (!(radius > 0)) return;
    const Vec3f center = camera.point(spheres[i].center);
    const float along = -center.z;
    if (along + radius < camera.near) return;  // behind the camera
    Samples x{0, camera.width - 1}, y{0, camera.height - 1};
    if (along - radius > camera.near) {  // otherwise it may fill the picture
      x = touched(center.x, along, radius, camera.tangent.x, camera.width);
      y = touched(center.y, along, radius, camera.tangent.y, camera.height);
    }
    constexpr float kNearer = 0.9999f;  // for rounding
    const float front = kNearer * (along - radius);
    const float best = positivePart(camera.depthAt(front > camera.near ? front : camera.near));
    if (tiles.hide(x, y, best)) return;
    for (int row = y.first + shares.part(k); row <= y.last; row += shares.parts)
      offerRow(row, x, i, center, radius, best);
  }

  WEIR_HD void offerRow(int row, const Samples& x, std::int64_t i, const Vec3f& center, float radius,
                        float best) const {
    const std::uint64_t number = kNoSphere - 1 - static_cast<std::uint32_t>(i);
    std::uint64_t* line = nearest.data + std::int64_t{row} * camera.width;
    const Vec3f straight = camera.ray(0, row);
    for (int column = x.first; column <= x.last; column += kPixels) {
      const Number now = depthsOfRow(line, column, camera.width);
      const Ints columns = intsFrom(column);
      const Mask open = notSo(now < Number(best)) & below(columns, x.last + 1);
      if (!any(open)) continue;  // all of it is hidden there
      const Numbers3 ray{((toNumbers(columns) + 0.5f) * (2.0f / float(camera.width)) - 1) * camera.tangent.x,
                         straight.y, straight.z};
      const Hit<Number> hit(ray, allOf(center), radius);
      const Number depth = positivePart(depthAt(hit.distance));
      const Mask missed = either(hit.rest < Number(0.0f), hit.distance < Number(camera.near));
      unsigned offered = bitsOfMask(open & notSo(either(missed, now < depth)));
      for (int l = 0; offered != 0; ++l, offered >>= 1)
        if ((offered & 1u) != 0)
          atomicMin(line + column + l, std::uint64_t{laneOf(bitsOfNumbers(depth), l)} << 32 | number);
    }
  }

  WEIR_HD Number depthAt(const Number& distance) const {
    return 0.5f + 0.5f * (camera.projection.w / distance - camera.projection.z);
  }
};

struct ClearNearest {
  ArrayView<std::uint64_t> nearest;
  WEIR_HD void operator()(std::int64_t k) const { nearest[k] = kNobody; }
};

/// -1 … 1 as a number of ten bits.
WEIR_HD std::uint32_t tenBits(float component) {
  constexpr float kMost = 1023;
  const float half = 0.5f + 0.5f * component;
  return static_cast<std::uint32_t>((half > 0 ? (half < 1 ? half : 1.0f) : 0.0f) * kMost + 0.5f);
}

WEIR_HD std::uint32_t packedNormal(const Vec3f& n) {
  return tenBits(n.x) | tenBits(n.y) << 10 | tenBits(n.z) << 20 | 3u << 30;
}

struct WriteTexels {
  ArrayView<const SplatSphere> spheres;
  SplatCamera camera;
  ArrayView<const std::uint64_t> nearest;
  SplatTexels out;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::uint64_t seen = nearest[k];
    if (seen == kNobody) {
      out.albedo[k] = 0;
      out.normal[k] = packedNormal({0, 0, 1});
      out.depth[k] = 1;
      return;
    }
    const SplatSphere& sphere = spheres[kNoSphere - 1 - static_cast<std::uint32_t>(seen)];
    const Vec3f center = camera.point(sphere.center);
    const Vec3f ray = camera.ray(static_cast<int>(k % camera.width), static_cast<int>(k / camera.width));
    const Hit<float> hit(ray, center, sphere.radius);
    out.albedo[k] = sphere.color;
    out.normal[k] = packedNormal((ray * hit.distance - center) / sphere.radius);
    out.depth[k] = std::bit_cast<float>(static_cast<std::uint32_t>(seen >> 32));
  }
};

struct ClearShadow {
  ArrayView<std::uint32_t> depthBits;
  WEIR_HD void operator()(std::int64_t k) const { depthBits[k] = kOneBits; }
};

struct OfferShadow {
  ArrayView<const SplatSphere> spheres;
  Shares shares;
  SplatSun sun;
  ArrayView<std::uint32_t> depthBits;
  std::int64_t first;  // share
  FarthestTiles tiles;

  WEIR_HD void operator()(std::int64_t later) const {
    const std::int64_t k = first + later, i = shares.sphere(k);
    if (i >= shares.spheres || !(spheres[i].radius > 0)) return;
    const Vec3f center = sun.point(spheres[i].center);
    const float radius = spheres[i].radius / sun.halfSize;  // in clip space
    const Samples x = Samples::between(center.x - radius, center.x + radius, sun.resolution);
    const Samples y = Samples::between(center.y - radius, center.y + radius, sun.resolution);
    const float texel = 2.0f / float(sun.resolution);
    const float thick = spheres[i].radius * sun.zToDepth;
    const float best = positivePart(0.5f + 0.5f * (center.z - thick));
    if (tiles.hide(x, y, best)) return;
    for (int row = y.first + shares.part(k); row <= y.last; row += shares.parts) {
      const float v = ((float(row) + 0.5f) * texel - 1 - center.y) / radius;
      std::uint32_t* line = depthBits.data + std::int64_t{row} * sun.resolution;
      for (int column = x.first; column <= x.last; column += kPixels) {
        const Number now = depthsOfRow(line, column, sun.resolution);
        const Ints columns = intsFrom(column);
        const Mask open = notSo(now < Number(best)) & below(columns, x.last + 1);
        if (!any(open)) continue;
        const Number u = ((toNumbers(columns) + 0.5f) * texel - 1 - center.x) / radius;
        const Number rest = 1 - (u * u + v * v);
        const Number depth = positivePart(0.5f + 0.5f * (center.z - thick * sqrtf(positivePart(rest))));
        unsigned offered = bitsOfMask(open & (depth < now) & notSo(rest < Number(0.0f)));
        for (int l = 0; offered != 0; ++l, offered >>= 1)
          if ((offered & 1u) != 0) atomicMin(line + column + l, laneOf(bitsOfNumbers(depth), l));
      }
    }
  }
};

}  // namespace

template <class Backend>
void splatDepths(Backend& device, ArrayView<const SplatSphere> spheres, const SplatCamera& camera,
                 ArrayView<std::uint64_t> nearest) {
  const Shares shares(spheres.size);
  offerInRounds(device, "offerDepths", shares, nearest, camera.width,
                [&](std::int64_t first, const FarthestTiles& tiles) {
                  return OfferDepths{spheres, shares, camera, nearest, first, tiles};
                });
}

template <class Backend>
void splatGeometry(Backend& device, ArrayView<const SplatSphere> spheres, const SplatCamera& camera,
                   ArrayView<std::uint64_t> nearest, const SplatTexels& out) {
  parallelFor(device, "clearNearest", nearest.size, ClearNearest{nearest});
  splatDepths(device, spheres, camera, nearest);
  parallelFor(device, "writeTexels", nearest.size, WriteTexels{spheres, camera, nearest, out});
}

template <class Backend>
void splatShadow(Backend& device, ArrayView<const SplatSphere> spheres, const SplatSun& sun,
                 ArrayView<std::uint32_t> depthBits) {
  parallelFor(device, "clearShadow", depthBits.size, ClearShadow{depthBits});
  const Shares shares(spheres.size);
  offerInRounds(device, "offerShadow", shares, depthBits, sun.resolution,
                [&](std::int64_t first, const FarthestTiles& tiles) {
                  return OfferShadow{spheres, shares, sun, depthBits, first, tiles};
                });
}

template void splatDepths(ThisBackend&, ArrayView<const SplatSphere>, const SplatCamera&,
                          ArrayView<std::uint64_t>);
template void splatGeometry(ThisBackend&, ArrayView<const SplatSphere>, const SplatCamera&,
                            ArrayView<std::uint64_t>, const SplatTexels&);
template void splatShadow(ThisBackend&, ArrayView<const SplatSphere>, const SplatSun&,
                          ArrayView<std::uint32_t>);

}  // namespace weir::rendering::gl
