// Makes a view of a simulation: what there is to see, from where, in which colours.
#pragma once

#include <string>
#include <vector>

#include "framework/run/simulation.h"
#include "nodes/solids/solid.h"
#include "nodes/static_boundary/shapes.h"
#include "plugins/rendering/gl/renderer.h"
#include "plugins/rendering/render_settings.h"
#include "plugins/rendering/view.h"

namespace weir::rendering {

/// What the colours of a view mean.
struct ColorKey {
  bool shown = false;  ///< false if the particles have one colour
  std::string quantity, unit;
  float low = 0, high = 1;  ///< values at the ends of the colour map
};

class SceneView {
 public:
  /// Gives its surfaces to the renderer, which must outlive it.
  SceneView(const RenderSettings& settings, gl::Renderer& renderer)
      : settings_(settings), renderer_(renderer) {}

  /// The view at the present frame; it points to what this object holds until the next call. Waits for the
  /// device. Throws a scene Error if the settings name what the
  /// scene does not have.
  View at(Simulation& simulation);
  /// Of the view that at() made last.
  const ColorKey& colorKey() const { return key_; }

 private:
  void collectStatic(Simulation& simulation);
  void addShape(const Shape& shape, const std::string& node);
  void addSurface(const TriangleMesh& mesh, const std::string& node, const RigidMotion* motion = nullptr);
  void addFluids(Simulation& simulation, View& view);
  void chooseRange();  // of values_
  CameraPose cameraAt(double time) const;
  CameraPose restingCamera() const;
  const SurfaceSettings* settingsOf(const std::string& node) const;
  void checkNames(const Simulation& simulation) const;

  const RenderSettings& settings_;
  gl::Renderer& renderer_;
  ColorKey key_;
  std::vector<std::vector<Vec3f>> positions_;  // of each fluid
  std::vector<std::vector<float>> values_;     // empty for one colour

  // What does not change during a run.
  bool collected_ = false;
  std::vector<SurfaceView> surfaces_;
  std::vector<const RigidMotion*> motions_;  // of each surface, null for those at rest
  std::vector<Vec3f> lines_;                 // two points a line
  Aabb bounds_;
  bool boundsAreStatic_ = false;  // else they grow with the particles
  float floor_ = 0;
  bool hasFloor_ = false;  // whether a plane is the ground
  bool rangeFound_ = false;
};

}  // namespace weir::rendering
