// Closed meshes that are the surface of a liquid: the same maps that WaterDrawer makes of particles.
#pragma once

#include "plugins/rendering/gl/mesh_store.h"
#include "plugins/rendering/gl/water_drawer.h"

namespace weir::rendering::gl {

class WaterSurfacePass {
 public:
  explicit WaterSurfacePass(const Functions& gl);

  // Each draws the meshes of one liquid, View::waters[water], into what WaterDrawer has drawn there, which is
  // bound and `size` texels large.

  /// Depth, and the normal in camera space with an alpha of 1, which says that it is one.
  void drawDepth(const Frame& frame, std::size_t water, const MeshStore& meshes, const Vec2i& size) const;
  /// Adds the distances of back sides and takes away those of front sides, so that what remains is the way
  /// through the inside.
  void drawThickness(const Frame& frame, std::size_t water, const MeshStore& meshes, const Vec2i& size) const;
  void drawSunDepth(const Frame& frame, std::size_t water, const MeshStore& meshes, const Vec2i& size) const;
  void drawSunThickness(const Frame& frame, std::size_t water, const MeshStore& meshes,
                        const Vec2i& size) const;

 private:
  void draw(const Frame& frame, const Program& program, std::size_t water, const MeshStore& meshes,
            const Vec2i& size, bool fromSun) const;
  void addThickness(const Frame& frame, std::size_t water, const MeshStore& meshes, const Vec2i& size,
                    bool fromSun) const;

  const Functions& gl_;
  Program surface_, thickness_;
};

}  // namespace weir::rendering::gl
