// Particles as spheres that a compute device finds the nearest of at each sample (splat_kernels.h). OpenGL
// gets finished texels, which is much faster than triangles where OpenGL is software.
#pragma once

#include "plugins/rendering/compute/device_output.h"
#include "plugins/rendering/compute/sphere_set.h"
#include "plugins/rendering/gl/particle_drawer.h"
#include "plugins/rendering/gl/splat_kernels.h"

namespace weir::rendering::gl {

class SplatPass final : public ParticleDrawer {
 public:
  /// No other thread may use the device.
  SplatPass(const Functions& gl, Device& device);

  Aabb load(std::span<const ParticleView> views) override;
  bool replacesAll() const override { return spheres_.view().size > 0; }
  void drawGeometry(const Frame& frame, const Targets& targets) override;
  void drawShadow(const SunView& sun, const Texture& map, int resolution) override;

 private:
  const Functions& gl_;
  Device& device_;
  SphereSet spheres_;
  Array<std::uint64_t> nearest_;
  Array<std::uint32_t> albedo_, normal_, shadow_;
  Array<float> depth_;
  DeviceOutput<std::uint32_t> albedoCopy_, normalCopy_, shadowCopy_;
  DeviceOutput<float> depthCopy_;
};

}  // namespace weir::rendering::gl
