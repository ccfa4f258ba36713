// Glass over the lit scene: it tints what is behind it, and mirrors the surroundings, most at its rims.
#pragma once

#include "plugins/rendering/gl/environment.h"
#include "plugins/rendering/gl/frame.h"
#include "plugins/rendering/gl/mesh_store.h"

namespace weir::rendering::gl {

class GlassPass {
 public:
  explicit GlassPass(const Functions& gl) : gl_(gl) {}

  /// Into Targets::lightWithDepth. Light goes straight through, without refraction, so that what is inside is
  /// seen where it is. Surfaces come in the order of their distances, the inner sides before the outer ones.
  /// Only what lies behind the depth that `before` holds is drawn: one texel, or one per sample.
  void draw(const Frame& frame, const Targets& targets, const MeshStore& meshes, const Texture& before,
            const Environment& environment) const;

 private:
  const Functions& gl_;
  Program program_{gl_, "surface.vert", "glass.frag"};
};

}  // namespace weir::rendering::gl
