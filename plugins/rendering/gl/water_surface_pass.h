// Closed meshes that are the surface of a liquid: the same maps that SphereDrawer makes of particles.
#pragma once

#include "plugins/rendering/gl/frame.h"
#include "plugins/rendering/gl/mesh_store.h"

namespace weir::rendering::gl {

/// The meshes of one liquid, View::waters[water], and who sees them.
struct SeenWater {
  const Frame& frame;
  std::size_t water;
  const MeshStore& meshes;
  Vec2i size;            ///< texels of the map
  bool fromSun = false;  ///< or by the camera
};

class WaterSurfacePass {
 public:
  explicit WaterSurfacePass(const Functions& gl) : gl_(gl) {}

  // Each draws into what SphereDrawer has drawn, which is bound.

  /// Depth, and the normal in camera space with an alpha of 1, which says that it is one.
  void drawDepth(const SeenWater& seen) const;
  /// Adds the distances of back sides and takes away those of front sides, so that what remains is the way
  /// through the inside.
  void drawThickness(const SeenWater& seen) const;

 private:
  const Functions& gl_;
  Program surface_{gl_, "surface.vert", "water_surface.frag"};
  Program thickness_{gl_, "surface.vert", "water_inside.frag"};
};

}  // namespace weir::rendering::gl
