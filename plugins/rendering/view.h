// One picture to be drawn, as plain data on the host.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "nodes/geometry/triangle_mesh.h"
#include "plugins/rendering/render_settings.h"

namespace weir::rendering {

/// Particles as spheres. `shade` in [0, 1] chooses the colour from the view's colours.
struct Spheres {
  std::vector<Vec3f> positions;  ///< m
  std::vector<float> shade;      ///< as many as positions
  float radius = 0;              ///< m
};

struct Surface {
  std::shared_ptr<const TriangleMesh> mesh;
  SurfaceLook look = SurfaceLook::kMatt;
  Color color;
};

struct Line {
  Vec3f from, to;  ///< m
};

struct Camera {
  Vec3f eye, target, up{0, 1, 0};  ///< m
  float fov = 40;                  ///< vertical, degrees
};

struct View {
  int width = 0, height = 0;  ///< pixels
  Camera camera;
  std::vector<Spheres> spheres;
  std::vector<std::uint8_t> colors;  ///< RGB triples from shade 0 to shade 1, sRGB
  std::vector<Surface> surfaces;
  std::vector<Line> lines;
  bool ground = true;
  float groundHeight = 0;  ///< m
  Aabb bounds;             ///< of what is worth looking at: sets shadows and the size of effects
  Color backgroundTop, backgroundBottom;
};

}  // namespace weir::rendering
