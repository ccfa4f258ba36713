// Particles as spheres that a compute device finds the nearest of at each sample (splat_kernels.h). OpenGL
// gets finished texels, which is much faster than triangles where OpenGL is software.
#pragma once

#include "framework/compute/host_copy.h"
#include "plugins/rendering/compute/sphere_set.h"
#include "plugins/rendering/gl/particle_drawer.h"
#include "plugins/rendering/gl/splat_kernels.h"

namespace weir::rendering::gl {

class SplatPass final : public ParticleDrawer {
 public:
  /// No other thread may use the device.
  SplatPass(const Functions& gl, Device& device);

  Aabb load(std::span<const ParticleView> views) override;
  bool comesFirst() const override { return true; }
  void drawGeometry(const Frame& frame, const Targets& targets) override;
  void drawShadow(const SunView& sun, const Texture& map, int resolution) override;

 private:
  /// The same numbers on the host.
  template <class T>
  const T* onHost(const Array<T>& array, HostCopy<T>& copy) const;

  const Functions& gl_;
  Device& device_;
  SphereSet spheres_;
  Array<std::uint64_t> nearest_;
  Array<std::uint32_t> albedo_, normal_, shadow_;
  Array<float> depth_;
  HostCopy<std::uint32_t> albedoCopy_, normalCopy_, shadowCopy_;
  HostCopy<float> depthCopy_;
};

}  // namespace weir::rendering::gl
