// Makes a view of a snapshot of a scene: what there is to see, from where, in which colours.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plugins/views/picture_maker.h"
#include "plugins/views/render_settings.h"
#include "plugins/views/scene_capture.h"
#include "plugins/views/shown_particles.h"
#include "plugins/views/view.h"

namespace weir::rendering {

/// What the colours of a view mean.
struct ColorKey {
  bool shown = false;  ///< false if the particles have one colour
  std::string quantity, unit;
  float low = 0, high = 1;  ///< values at the ends of the colour map
};

/// Where the particles of a view shall be.
enum class ParticlePlace {
  kWhereTheyAreDrawn,  ///< on the device if that draws the view, else on the host
  kHost,
};

/// Views depend on the frames before, because ranges and bounds grow: snapshots must come in their order.
class SceneView {
 public:
  /// Gives its surfaces to the maker of pictures, which must outlive it and have a device of the hardware
  /// that the snapshots come from. Throws an io Error if a file that the settings name is wrong.
  /// `ranks`: snapshots have the particles of each, and all make views of them together, which are alike but
  /// for their particles, if no camera follows these.
  SceneView(const RenderSettings& settings, const CameraSettings& camera, PictureMaker& maker,
            Communicator* ranks = nullptr);

  /// The view of a frame; it points to what this object and the snapshot hold until the next call.
  View of(SceneSnapshot& snapshot, ParticlePlace place = ParticlePlace::kWhereTheyAreDrawn);
  /// Of the view that was made last.
  const ColorKey& colorKey() const { return key_; }
  const ColorMap& colorMap() const { return map_; }
  /// Null if they are not a picture.
  const EnvironmentImage* surroundings() const { return image_.get(); }
  /// Light and surroundings of all views with these settings, but for the light of a picture of these.
  static void addEnvironment(const RenderSettings& settings, View& view);

 private:
  /// Surfaces of the same water share one, which is drawn as a whole: pieces of a sea hide no light from each
  /// other where they meet.
  std::size_t indexOfWater(const WaterView& water);
  void takeStill(const StillScene& still);
  void addFluids(SceneSnapshot& snapshot, View& view);
  void addWater(const FluidSnapshot& fluid, View& view);
  /// Lone particles of liquids become drops, as water of their size does not hold together.
  void addSpray(const SceneSnapshot& snapshot, View& view);
  void addArrows(SceneSnapshot& snapshot, View& view);
  void addFluidSurfaces(SceneSnapshot& snapshot, View& view);
  void loadSurfaceFluids(SceneSnapshot& snapshot);
  /// Of the fluid at each vertex of its surface; none of what is not captured.
  struct SurfaceFields {
    std::vector<Vec3f> velocities, colors;  // m/s; sRGB
    std::vector<float> foam;                // SurfaceFoam::cover
  };
  void findFields(const FluidSnapshot& fluid, const MeshSpan& mesh, ShownParticles& shown,
                  SurfaceFields& fields) const;
  /// Lays foam on the surfaces that it covers, in place of its particles, which have radius 0 then.
  void addFoam(SceneSnapshot& snapshot, View& view);
  void chooseRange(const View& view);
  /// Where that is what the camera follows; nothing if it follows nothing, or nothing is there.
  std::optional<Vec3f> followedPlace(const SceneSnapshot& snapshot);
  CameraPose restingCamera() const;

  const RenderSettings& settings_;
  const CameraSettings& camera_;
  PictureMaker& maker_;
  Communicator* ranks_;
  Device& device_;  // the maker's
  ColorMap map_;
  std::shared_ptr<const EnvironmentImage> image_;  // of the surroundings, or null
  ColorKey key_;
  std::vector<Cut> cuts_;
  std::vector<std::unique_ptr<ShownParticles>> shown_;  // of each fluid
  std::vector<std::unique_ptr<ShownParticles>> spray_;  // of each liquid that has some
  // For arrows: what the device had no room for, and what it has as the host sees it.
  Array<Vec3f> placeRoom_{device_}, velocityRoom_{device_};
  DeviceOutput<Vec3f> placesOnHost_{device_}, velocitiesOnHost_{device_};
  std::vector<std::unique_ptr<ShownParticles>> surfaceFluids_;  // behind each surface of a fluid
  std::vector<SurfaceFields> fieldsOfSurfaces_;
  std::vector<std::vector<float>> foamRadii_;  // of each fluid whose foam was laid on a surface
  std::vector<Vec3f> arrows_;                  // two points a line
  std::vector<SurfaceView> surfaces_;          // that are still
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
