#include "plugins/cycles/blender_output.h"

#include <optional>
#include <utility>

#include "framework/base/text.h"
#include "plugins/cycles/blender_program.h"
#include "plugins/cycles/handover.h"
#include "plugins/views/picture_maker.h"
#include "plugins/views/scene_capture.h"
#include "plugins/views/scene_view.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

constexpr const char* kOption = "blender";
constexpr const char* kBlendFile = "scene.blend";

/// Takes what views show, and draws nothing.
class FolderOfFrames final : public PictureMaker {
 public:
  FolderOfFrames(std::unique_ptr<Device> device, const fs::path& folder, const CyclesSettings& settings,
                 double frameRate)
      : device_(std::move(device)), handover_(folder, settings, frameRate) {}

  MeshId addMesh(const TriangleMesh& mesh) override { return handover_.addMesh(mesh); }
  void replaceMesh(MeshId id, const ShownMesh& mesh) override { handover_.replaceMesh(id, mesh); }
  Picture draw(const View& view) override {
    last_ = handover_.write(view);
    return {};
  }
  Device* device() const override { return device_.get(); }
  bool readsDevice(const View&) const override { return false; }

  /// The file of the last frame; "" without one.
  const fs::path& last() const { return last_; }

 private:
  std::unique_ptr<Device> device_;
  Handover handover_;
  fs::path last_;
};

class BlenderObserver final : public Observer {
 public:
  explicit BlenderObserver(fs::path folder) : folder_(std::move(folder)) {}

  std::string name() const override { return "frames for Blender"; }
  std::string_view stateName() const override { return "blender"; }

  void begin(Simulation& simulation) override {
    const auto& settings = static_cast<const RenderSettings&>(*simulation.scene().sections.at("render"));
    frames_.emplace(siblingOf(simulation.device()), folder_, *settings.cycles,
                    simulation.scene().world.frameRate);
    view_.emplace(settings, *settings.camera, *frames_);
    capture_.emplace(settings, CaptureNeeds{.velocities = true, .closedWater = true});
  }
  /// Frames are files of their own, with the numbers that follow.
  void resume(Simulation& simulation, const StateReader&) override { begin(simulation); }
  void save(const StateWriter& to) override { to.put("frames", std::int64_t{1}); }

  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override {
    return capture_->at(simulation,
                        std::unique_ptr<SceneSnapshot>(static_cast<SceneSnapshot*>(used.release())));
  }
  void write(Snapshot& snapshot) override {
    frames_->draw(view_->of(static_cast<SceneSnapshot&>(snapshot), ParticlePlace::kHost));
  }

  void end(Simulation& simulation, RunEnd how) override {
    if (frames_->last().empty() || how == RunEnd::kFailed) return;
    const std::string file = printable((folder_ / kBlendFile).string(), 1000);
    try {
      if (BlenderProgram().save(frames_->last(), folder_ / kBlendFile))
        simulation.log().info(file + " shows the last frame");
    } catch (const Error& error) {
      // The frames are there, and the add-on opens them elsewhere.
      simulation.log().warn(file + " was not made: " + error.message());
    }
  }

 private:
  fs::path folder_;
  std::optional<FolderOfFrames> frames_;
  std::optional<SceneView> view_;
  std::optional<SceneCapture> capture_;
};

}  // namespace

std::vector<OutputOption> BlenderOutput::options() const {
  return {
      {kOption, "DIR", {}, "Write a folder that Blender opens with Weir's add-on, and scene.blend in it"}};
}

std::unique_ptr<Observer> BlenderOutput::create(const OutputPaths& paths) const {
  return std::make_unique<BlenderObserver>(paths.at(kOption));
}

}  // namespace weir::rendering
