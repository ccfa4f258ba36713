// Draws a view off screen.
//
// Every pixel is made of 2 × 2 samples. The passes are:
//   shadow     depth of everything opaque as the sun sees it
//   geometry   colour, normal and depth of everything opaque; spheres are quads on which rays are traced
//   occlusion  ambient occlusion at the size of the picture, then a blur
//   shade      light, background
//   glass      transparent surfaces over it, far sides before near sides; lines
//   resolve    samples to pixels, light to sRGB
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "plugins/rendering/gl/context.h"
#include "plugins/rendering/gl/objects.h"
#include "plugins/rendering/output/picture.h"
#include "plugins/rendering/view.h"

namespace weir::rendering {

class Renderer {
 public:
  /// The context is made current by every call of draw().
  explicit Renderer(std::unique_ptr<Context> context);
  ~Renderer();

  Picture draw(const View& view);

 private:
  struct Shaders;
  struct Targets;
  struct Frame;

  void prepare(const View& view);
  void drawShadows(const View& view, const Frame& frame);
  void drawGeometry(const View& view, const Frame& frame);
  void drawOcclusion(const Frame& frame);
  void shade(const View& view, const Frame& frame);
  void drawGlass(const View& view, const Frame& frame);
  void drawLines(const View& view, const Frame& frame);
  Picture resolve();
  void drawFullScreen();
  void setLighting(const Shader& shader, const View& view, const Frame& frame) const;
  const VertexArray& verticesOf(const std::shared_ptr<const TriangleMesh>& mesh);

  std::unique_ptr<Context> context_;
  Functions gl_;
  std::unique_ptr<Shaders> shaders_;
  std::unique_ptr<Targets> targets_;  // of the size of the last view
  VertexArray screen_, ground_, lines_;
  std::vector<VertexArray> spheres_;
  Texture colors_;
  /// Vertices of meshes that were drawn before; the mesh is kept, so that its address stays its own.
  std::map<std::shared_ptr<const TriangleMesh>, VertexArray> meshes_;
};

/// Positions and normals of all corners, 6 floats each. Normals are smooth except across edges of more than
/// `crease` degrees.
std::vector<float> meshVertices(const TriangleMesh& mesh, float crease = 35);

}  // namespace weir::rendering
