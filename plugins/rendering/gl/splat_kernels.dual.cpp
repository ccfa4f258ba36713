#include "plugins/rendering/gl/splat_kernels.h"

#include <bit>
#include <cmath>

#include "framework/compute/atomic_min.h"
#include "framework/compute/parallel.h"
#include "plugins/rendering/gl/splat_shapes.h"

namespace weir::rendering::gl {

namespace {

constexpr std::uint64_t kNobody = std::uint64_t{kOneBits} << 32 | kNoSphere;

struct OfferDepths {
  ArrayView<const SplatSphere> spheres;
  Shares shares;
  SplatCamera camera;
  ArrayView<std::uint64_t> nearest;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = shares.sphere(k);
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
    const std::uint64_t best =
        std::uint64_t{bitsOf(camera.depthAt(front > camera.near ? front : camera.near))} << 32;
    const std::uint64_t number = kNoSphere - 1 - static_cast<std::uint32_t>(i);
    for (int row = y.first + shares.part(k); row <= y.last; row += shares.parts) {
      std::uint64_t* line = nearest.data + std::int64_t{row} * camera.width;
      for (int column = x.first; column <= x.last; ++column) {
        if (currentLeast(line + column) < best) continue;  // all of it is hidden there
        const Hit hit(camera.ray(column, row), center, radius);
        if (hit.rest < 0 || hit.distance < camera.near) continue;
        atomicMin(line + column, std::uint64_t{bitsOf(camera.depthAt(hit.distance))} << 32 | number);
      }
    }
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
    const Hit hit(ray, center, sphere.radius);
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

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = shares.sphere(k);
    if (i >= shares.spheres || !(spheres[i].radius > 0)) return;
    const Vec3f center = sun.point(spheres[i].center);
    const float radius = spheres[i].radius / sun.halfSize;  // in clip space
    const Samples x = Samples::between(center.x - radius, center.x + radius, sun.resolution);
    const Samples y = Samples::between(center.y - radius, center.y + radius, sun.resolution);
    const float texel = 2.0f / float(sun.resolution);
    const float thick = spheres[i].radius * sun.zToDepth;
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

}  // namespace

template <class Backend>
void splatDepths(Backend& device, ArrayView<const SplatSphere> spheres, const SplatCamera& camera,
                 ArrayView<std::uint64_t> nearest) {
  const Shares shares(spheres.size);
  parallelFor(device, "offerDepths", shares.count(), OfferDepths{spheres, shares, camera, nearest});
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
  parallelFor(device, "offerShadow", shares.count(), OfferShadow{spheres, shares, sun, depthBits});
}

template void splatDepths(ThisBackend&, ArrayView<const SplatSphere>, const SplatCamera&,
                          ArrayView<std::uint64_t>);
template void splatGeometry(ThisBackend&, ArrayView<const SplatSphere>, const SplatCamera&,
                            ArrayView<std::uint64_t>, const SplatTexels&);
template void splatShadow(ThisBackend&, ArrayView<const SplatSphere>, const SplatSun&,
                          ArrayView<std::uint32_t>);

}  // namespace weir::rendering::gl
