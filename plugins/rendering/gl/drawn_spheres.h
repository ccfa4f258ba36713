// Particles by OpenGL: spheres with exact outlines, of a rectangle around each one's picture and a ray per
// sample, and rectangles that add up for the thickness of liquids.
#pragma once

#include <optional>
#include <vector>

#include "plugins/rendering/gl/sphere_batches.h"
#include "plugins/rendering/gl/sphere_drawer.h"

namespace weir::rendering::gl {

class DrawnSpheres final : public SphereDrawer {
 public:
  explicit DrawnSpheres(const Functions& gl) : gl_(gl) {}

  /// Sends the particles to the GPU.
  Aabb load(std::span<const ParticleView> views) override;
  bool replacesAll() const override { return false; }
  void drawGeometry(const Frame& frame, const Targets& targets) override;
  void drawSunDepth(const SunView& sun, Liquid liquid, const Texture& depth) override;
  void drawDepth(const Frame& frame, std::size_t liquid, const Texture& depth) override;
  void drawThickness(const Frame& frame, std::size_t liquid, const Texture& front, const Canvas& background,
                     const Texture& map) override;
  void drawSunThickness(const SunView& sun, std::size_t liquid, const Texture& map) override;

 private:
  /// The particles of one view.
  struct Group {
    Liquid liquid;
    bool white;  // water
    float radius, inset, chord;
    Texture colors;  // of the colour map; none of a liquid
  };
  /// Once there is a liquid: programs take time to build.
  struct LiquidPrograms {
    explicit LiquidPrograms(const Functions& gl)
        : depth(gl, "sphere.vert", "water_depth.frag"),
          thickness(gl, "water_thickness.vert", "water_thickness.frag") {}
    Program depth, thickness;
  };

  /// Calls setUniforms(group) before each batch, with the program in use. `white`: whether white water is
  /// drawn, too.
  template <class SetUniforms>
  void draw(const Program& program, Liquid liquid, const SetUniforms& setUniforms, bool white = true) const;
  /// In a program that is in use and has all uniforms but those of groups.
  void addThickness(std::size_t liquid, const Texture& map, float foamDepth) const;

  const Functions& gl_;
  Program geometry_{gl_, "sphere.vert", "particle.frag"};
  Program sunDepth_{gl_, "sun_sphere.vert", "sun_sphere.frag"};
  std::optional<LiquidPrograms> liquids_;
  SphereBatches batches_{gl_};
  Texture nothing_{gl_, 1, 1, kFloat1, GL_NEAREST};
  std::vector<Group> groups_;
};

}  // namespace weir::rendering::gl
