// Pictures of the particles of several ranks, of which nobody gathers them: each rank finds what is seen of
// its own, and rank 0 draws what is nearest.
#pragma once

#include <memory>
#include <vector>

#include "framework/communication/communicator.h"
#include "framework/run/observer.h"
#include "plugins/rendering/compute/compute_renderer.h"
#include "plugins/views/scene_capture.h"
#include "plugins/views/scene_view.h"

namespace weir::rendering {

/// Whether that can be done for all pictures of a scene: they show spheres, a plain ground and a few lines
/// alone, which ComputeRenderer draws, of particles that ranks share.
bool canBeComposited(const Scene& scene);

/// What rank 0 draws a frame of.
struct CompositedFrame final : public Snapshot {
  struct Picture {
    View view;  ///< without particles
    ColorKey key;
    SeenOfRanks seen;
  };
  SceneSnapshot scene;            ///< without what there is to see
  std::vector<Picture> pictures;  ///< of each camera, the first one first
};

class CompositedFrames {
 public:
  /// Of a scene that can be composited.
  CompositedFrames(const RenderSettings& settings, const Simulation& simulation, Communicator& ranks);

  /// The present frame, which all ranks find together. On rank 0; null on others.
  std::unique_ptr<Snapshot> at(Simulation& simulation);

 private:
  CompositedFrame::Picture pictureOf(SceneView& camera);

  Communicator& ranks_;
  std::unique_ptr<Device> device_;
  ComputeRenderer renderer_{*device_};
  SceneCapture capture_;
  std::vector<std::unique_ptr<SceneView>> cameras_;
  std::unique_ptr<SceneSnapshot> own_;
};

}  // namespace weir::rendering
