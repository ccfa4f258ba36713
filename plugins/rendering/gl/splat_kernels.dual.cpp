#include "plugins/rendering/gl/splat_kernels.h"

#include "framework/compute/parallel.h"
#include "plugins/rendering/gl/splat_offers.h"

namespace weir::rendering::gl {

namespace {

constexpr std::uint64_t kNobody = std::uint64_t{kOneBits} << 32 | kNoSphere;

template <class Least>
struct Clear {
  ArrayView<Least> nearest;
  Least farthest;
  WEIR_HD void operator()(std::int64_t k) const { nearest[k] = farthest; }
};

/// 0 … 1 as a number of 16 bits.
WEIR_HD std::uint32_t sixteenBits(float part) {
  return static_cast<std::uint32_t>(clamped(part, 0.0f, 1.0f) * 65535 + 0.5f);
}

WEIR_HD std::uint32_t storedNormal(const Vec3f& normal) {
  const Vec2f stored = shading::storedNormal(normal);
  return sixteenBits(stored.x) | sixteenBits(stored.y) << 16;
}

struct WriteTexels {
  ArrayView<const SplatSphere> spheres;
  SplatCamera camera;
  ArrayView<const std::uint64_t> nearest;
  SplatTexels out;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::uint64_t seen = nearest[k];
    out.depthBits[k] = static_cast<std::uint32_t>(seen >> 32);
    if (seen == kNobody) {
      out.albedo[k] = 0;
      out.normal[k] = storedNormal({0, 0, 1});
      return;
    }
    const SplatSphere& sphere = spheres[kNoSphere - 1 - static_cast<std::uint32_t>(seen)];
    const Vec3f center = camera.view.point(sphere.center);
    const Vec3f ray = camera.ray(static_cast<int>(k % camera.width), static_cast<int>(k / camera.width));
    float rest;
    const float distance = shading::distanceOfSphere(ray, center, sphere.radius, rest);
    out.albedo[k] = sphere.color;
    out.normal[k] = storedNormal((ray * distance - center) / sphere.radius);
  }
};

}  // namespace

template <class Backend>
void splatDepths(Backend& device, ArrayView<const SplatSphere> spheres, const SplatCamera& camera,
                 ArrayView<std::uint64_t> nearest) {
  offerAll(device, "offerDepths", nearest, camera.width,
           OfferToCamera<std::uint64_t>{spheres, camera, 0, nearest});
}

template <class Backend>
void splatGeometry(Backend& device, ArrayView<const SplatSphere> spheres, const SplatCamera& camera,
                   ArrayView<std::uint64_t> nearest, const SplatTexels& out) {
  parallelFor(device, "clearNearest", nearest.size, Clear<std::uint64_t>{nearest, kNobody});
  splatDepths(device, spheres, camera, nearest);
  parallelFor(device, "writeTexels", nearest.size, WriteTexels{spheres, camera, nearest, out});
}

template <class Backend>
void clearDepths(Backend& device, ArrayView<std::uint32_t> depthBits) {
  parallelFor(device, "clear depths", depthBits.size, Clear<std::uint32_t>{depthBits, kOneBits});
}

template <class Backend>
void splatDepths(Backend& device, ArrayView<const SplatSphere> spheres, const SplatCamera& camera,
                 float inset, ArrayView<std::uint32_t> depthBits) {
  offerAll(device, "water depth", depthBits, camera.width,
           OfferToCamera<std::uint32_t>{spheres, camera, inset, depthBits});
}

template <class Backend>
void splatSunDepths(Backend& device, ArrayView<const SplatSphere> spheres, const SplatSun& sun,
                    ArrayView<std::uint32_t> depthBits) {
  offerAll(device, "offerShadow", depthBits, sun.resolution, OfferToSun{spheres, sun, depthBits});
}

template void splatDepths(ThisBackend&, ArrayView<const SplatSphere>, const SplatCamera&,
                          ArrayView<std::uint64_t>);
template void splatGeometry(ThisBackend&, ArrayView<const SplatSphere>, const SplatCamera&,
                            ArrayView<std::uint64_t>, const SplatTexels&);
template void clearDepths(ThisBackend&, ArrayView<std::uint32_t>);
template void splatDepths(ThisBackend&, ArrayView<const SplatSphere>, const SplatCamera&, float,
                          ArrayView<std::uint32_t>);
template void splatSunDepths(ThisBackend&, ArrayView<const SplatSphere>, const SplatSun&,
                             ArrayView<std::uint32_t>);

}  // namespace weir::rendering::gl
