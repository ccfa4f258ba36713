#include "plugins/pictures/live_view.h"

#include <mutex>
#include <optional>
#include <utility>

#include "plugins/pictures/overlay_text.h"
#include "plugins/rendering/make_renderer.h"
#include "plugins/video/jpeg.h"
#include "plugins/video/video_writer.h"
#include "plugins/views/plot_history.h"
#include "plugins/views/scene_capture.h"
#include "plugins/views/scene_view.h"

namespace weir::rendering {

namespace {

class Watcher final : public LiveRenderer {
 public:
  explicit Watcher(const Simulation& simulation)
      : settings_(static_cast<const RenderSettings&>(*simulation.scene().sections.at("render"))),
        title_(simulation.scene().title),
        frameRate_(simulation.scene().world.frameRate),
        duration_(simulation.scene().world.duration),
        device_(simulation.device()),
        capture_(settings_),
        overlay_(fontFolder()) {}

  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override {
    auto snapshot =
        capture_.at(simulation, std::unique_ptr<SceneSnapshot>(static_cast<SceneSnapshot*>(used.release())));
    // It comes once, and the snapshot that brings it may never be drawn.
    if (snapshot->still) {
      const std::lock_guard lock(mutex_);
      still_ = std::move(snapshot->still);
    }
    return snapshot;
  }

  std::string draw(Snapshot& snapshot, const LivePictureOptions& options) override {
    return encodeJpeg(picture(static_cast<SceneSnapshot&>(snapshot), options, {}));
  }

  LivePixels pixels(Snapshot& snapshot, const LivePictureOptions& options) override {
    Picture drawn = picture(static_cast<SceneSnapshot&>(snapshot), options, {});
    return {.width = drawn.width, .height = drawn.height, .rgb = std::move(drawn.rgb)};
  }

  void startVideo(const std::filesystem::path& file, int width, int height) override {
    video_.emplace(file, VideoSize{width, height, frameRate_},
                   settings_.video->format(settings_.transparent));
    videoSize_ = {width, height};
    plots_.emplace(settings_.plots, duration_);
  }

  void addToVideo(Snapshot& snapshot, const LiveCamera& camera) override {
    auto& scene = static_cast<SceneSnapshot&>(snapshot);
    plots_->add(scene.time, scene.plotted);
    video_->write(
        picture(scene, {.camera = camera, .width = videoSize_.x, .height = videoSize_.y}, plots_->plots()));
  }

  void finishVideo() override { video_->finish(); }

 private:
  Picture picture(SceneSnapshot& scene, const LivePictureOptions& options, const std::vector<Plot>& plots) {
    if (!renderer_) {
      renderer_ = makeRenderer(device_);
      view_.emplace(settings_, *settings_.camera, *renderer_);
    }
    {
      const std::lock_guard lock(mutex_);
      scene.still = std::exchange(still_, nullptr);
    }
    View view = view_->of(scene);
    view.width = options.width;
    view.height = options.height;
    view.samplesPerAxis = options.samplesPerAxis;
    if (const std::optional<LiveCamera>& camera = options.camera)
      view.camera = {
          .eye = camera->eye, .target = camera->target, .up = camera->up, .fovDegrees = camera->fovDegrees};
    Picture picture = renderer_->draw(view);
    overlay_.draw(overlayText(settings_, title_, scene, view_->colorKey(), view_->colorMap(), plots),
                  picture);
    return picture;
  }

  const RenderSettings& settings_;
  std::string title_;
  double frameRate_, duration_;  // 1/s, s
  const Device& device_;         // of which only the kind is looked at
  SceneCapture capture_;
  std::mutex mutex_;
  std::shared_ptr<const StillScene> still_;  // on its way to the view
  std::unique_ptr<gl::Renderer> renderer_;   // made where it draws, as that takes a moment
  std::optional<SceneView> view_;
  Overlay overlay_;
  std::optional<VideoWriter> video_;
  Vec2i videoSize_{};
  std::optional<PlotHistory> plots_;
};

}  // namespace

std::vector<std::string> LiveView::videoExtensions() const {
  return rendering::videoExtensions();
}

std::unique_ptr<LiveRenderer> LiveView::open(Simulation& simulation) const {
  return std::make_unique<Watcher>(simulation);
}

}  // namespace weir::rendering
