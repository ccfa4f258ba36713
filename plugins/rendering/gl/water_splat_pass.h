// Particles of a liquid whose surface and thickness a compute device finds (water_kernels.h). OpenGL gets
// finished texels, which is much faster than triangles where OpenGL is software.
#pragma once

#include <vector>

#include "plugins/rendering/compute/device_output.h"
#include "plugins/rendering/gl/water_drawer.h"
#include "plugins/rendering/gl/water_kernels.h"

namespace weir::rendering::gl {

class WaterSplatPass final : public WaterDrawer {
 public:
  /// No other thread may use the device.
  WaterSplatPass(const Functions& gl, Device& device);

  Aabb load(std::span<const ParticleView> views) override;
  void drawDepth(const Frame& frame, std::size_t water, const Texture& depth) override;
  void drawThickness(const Frame& frame, std::size_t water, const Texture& front,
                     const LiquidBackground& background, const ThicknessMap& map) override;
  void drawSunDepth(const SunView& sun, std::size_t water, const Texture& depth, int resolution) override;
  void drawSunThickness(const SunView& sun, std::size_t water, const ThicknessMap& map) override;

 private:
  /// The particles of one liquid.
  struct Liquid {
    explicit Liquid(Device& device) : particles(device) {}
    std::vector<WaterParticle> packed;
    Array<WaterParticle> particles;
    float largest = 0;  // radius, m
  };

  Aabb loadOne(const ParticleView& particles);
  bool has(std::size_t water) const { return water < liquids_.size() && !liquids_[water].packed.empty(); }
  void addThickness(std::size_t water, ThicknessView view, const LiquidBetween& between,
                    const ThicknessMap& map);
  void upload(const Texture& texture, int width, int height, const TextureFormat& format,
              const void* texels) const;

  const Functions& gl_;
  Device& device_;
  std::vector<Liquid> liquids_;
  Array<std::uint32_t> depth_, sunDepth_, sums_;
  Array<float> background_;
  Array<Vec2f> thickness_;
  std::vector<float> backgroundOnHost_;
  DeviceOutput<std::uint32_t> depthCopy_;
  DeviceOutput<Vec2f> thicknessCopy_;
};

}  // namespace weir::rendering::gl
