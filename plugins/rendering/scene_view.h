// Makes a view of a snapshot of a scene: what there is to see, from where, in which colours.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plugins/rendering/gl/renderer.h"
#include "plugins/rendering/render_settings.h"
#include "plugins/rendering/scene_capture.h"
#include "plugins/rendering/shown_particles.h"
#include "plugins/rendering/view.h"

namespace weir::rendering {

/// What the colours of a view mean.
struct ColorKey {
  bool shown = false;  ///< false if the particles have one colour
  std::string quantity, unit;
  float low = 0, high = 1;  ///< values at the ends of the colour map
};

/// Views depend on the frames before, because ranges and bounds grow: snapshots must come in their order.
class SceneView {
 public:
  /// Gives its surfaces to the renderer, which must outlive it.
  /// Throws an io Error if a file that the settings name is wrong.
  SceneView(const RenderSettings& settings, const CameraSettings& camera, gl::Renderer& renderer);

  /// The view of a frame; it points to what this object and the snapshot hold until the next call. Waits
  /// until the particles have arrived, and takes the still scene from the first snapshot.
  View of(SceneSnapshot& snapshot);
  /// Of the view that was made last.
  const ColorKey& colorKey() const { return key_; }
  const ColorMap& colorMap() const { return map_; }
  /// Null if they are no picture.
  const EnvironmentImage* surroundings() const { return image_.get(); }

 private:
  void takeStill(StillScene& still);
  void addFluids(SceneSnapshot& snapshot, View& view);
  void addWater(FluidSnapshot& fluid, View& view);
  void addArrows(SceneSnapshot& snapshot, View& view);
  void addFluidSurfaces(SceneSnapshot& snapshot, View& view);
  void chooseRange();  // of values_
  /// Where that is what the camera follows; nothing if it follows nothing, or nothing is there.
  std::optional<Vec3f> followedPlace(SceneSnapshot& snapshot) const;
  CameraPose restingCamera() const;
  void addEnvironment(View& view) const;

  const RenderSettings& settings_;
  const CameraSettings& camera_;
  gl::Renderer& renderer_;
  ColorMap map_;
  std::shared_ptr<const EnvironmentImage> image_;  // of the surroundings, or null
  ColorKey key_;
  std::vector<std::vector<float>> values_;  // of each fluid of spheres; empty for one colour
  std::vector<std::vector<float>> foam_;    // of each fluid that is a liquid; empty for none
  std::vector<ShownParticles> shown_;       // of each fluid, where clips hide some
  std::vector<Vec3f> arrows_;               // two points a line
  std::vector<SurfaceView> surfaces_;       // that are still
  std::vector<MeshId> fluidSurfaces_;
  std::vector<WaterView> surfaceWaters_;  // of those surfaces that are one's; they come first in a view
  std::optional<std::size_t> followedSurface_;
  Vec3f followedMiddle_;      // of that surface's mesh
  std::vector<Vec3f> lines_;  // two points a line
  Aabb bounds_;
  bool boundsAreStatic_ = false;  // else they grow with the particles
  std::optional<float> floor_;    // height of the plane that is the ground
  bool rangeFound_ = false;
};

}  // namespace weir::rendering
