// Particles as spheres that a compute device finds the nearest of at each sample (splat_kernels.h), and the
// thickness of liquids likewise (thickness_kernels.h). OpenGL gets finished texels, which is much faster than
// triangles where OpenGL is software.
#pragma once

#include <vector>

#include "plugins/rendering/compute/sphere_set.h"
#include "plugins/rendering/gl/sphere_drawer.h"
#include "plugins/rendering/gl/thickness_kernels.h"
#include "plugins/views/device_output.h"

namespace weir::rendering::gl {

class SplattedSpheres final : public SphereDrawer {
 public:
  /// No other thread may use the device.
  explicit SplattedSpheres(Device& device) : device_(device) {}

  Aabb load(std::span<const ParticleView> views) override { return spheres_.load(views); }
  bool replacesAll() const override { return spheres_.opaque().spheres.size > 0; }
  void drawGeometry(const Frame& frame, const Targets& targets) override;
  void drawSunDepth(const SunView& sun, Liquid liquid, const Texture& depth) override;
  void drawDepth(const Frame& frame, std::size_t liquid, const Texture& depth) override;
  void drawThickness(const Frame& frame, std::size_t liquid, const Texture& front, const Canvas& background,
                     const Texture& map) override;
  void drawSunThickness(const SunView& sun, std::size_t liquid, const Texture& map) override;

 private:
  void addThickness(std::size_t liquid, ThicknessView view, const LiquidBetween& between, const Texture& map);

  Device& device_;
  SphereSet spheres_{device_};
  Array<std::uint64_t> nearest_{device_};
  Array<std::uint32_t> albedo_{device_}, normal_{device_}, depth_{device_}, sunDepth_{device_},
      sums_{device_};
  Array<float> background_{device_};
  Array<Vec2f> thickness_{device_};
  std::vector<float> backgroundOnHost_;
  DeviceOutput<std::uint32_t> texels_{device_}, normals_{device_}, depths_{device_};
  DeviceOutput<Vec2f> thicknesses_{device_};
};

}  // namespace weir::rendering::gl
