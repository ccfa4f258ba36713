#include "plugins/rendering/picture_output.h"

#include <optional>

#include "framework/base/text.h"
#include "plugins/rendering/gl/renderer.h"
#include "plugins/rendering/output/image_sequence.h"
#include "plugins/rendering/output/video_writer.h"
#include "plugins/rendering/overlay.h"
#include "plugins/rendering/scene_view.h"

namespace weir::rendering {

namespace {

constexpr const char* kVideo = "video";
constexpr const char* kImages = "images";

class Pictures final : public Observer {
 public:
  explicit Pictures(const OutputPaths& paths) : paths_(paths) {}

  void begin(Simulation& simulation) override {
    const auto& settings = static_cast<const RenderSettings&>(*simulation.scene().sections.at("render"));
    renderer_ = std::make_unique<Renderer>(makeContext(providerFromEnvironment()));
    view_ = std::make_unique<SceneView>(settings);
    if (settings.overlay || settings.color->bar) overlay_ = std::make_unique<Overlay>(fontFile());
    showText_ = settings.overlay;
    if (const auto path = paths_.find(kVideo); path != paths_.end())
      video_.emplace(path->second, settings.width, settings.height, simulation.scene().world.frameRate);
    if (const auto path = paths_.find(kImages); path != paths_.end()) images_.emplace(path->second);
  }

  void frame(Simulation& simulation) override {
    Picture picture = renderer_->draw(view_->at(simulation));
    if (overlay_) drawOverlay(simulation, picture);
    if (images_) images_->write(picture);
    if (video_) video_->write(std::move(picture));
  }

  void end(Simulation& simulation, RunEnd) override {
    if (images_) {
      images_->finish();
      if (const std::string leftovers = images_->leftovers(); !leftovers.empty())
        simulation.log().warn(leftovers);
    }
    if (video_) video_->finish();
  }

 private:
  void drawOverlay(const Simulation& simulation, Picture& picture) {
    if (showText_)
      overlay_->drawCaption(picture, simulation.scene().title, simulation.time(), simulation.particleCount());
    const ColorKey& key = view_->colorKey();
    if (key.shown) {
      const auto& settings = static_cast<const RenderSettings&>(*simulation.scene().sections.at("render"));
      overlay_->drawColorBar(picture, {key.quantity, key.unit, key.low, key.high, settings.color->map});
    }
  }

  OutputPaths paths_;
  std::unique_ptr<Renderer> renderer_;
  std::unique_ptr<SceneView> view_;
  std::unique_ptr<Overlay> overlay_;
  bool showText_ = false;
  std::optional<VideoWriter> video_;
  std::optional<ImageSequence> images_;
};

}  // namespace

std::vector<OutputOption> PictureOutput::options() const {
  return {{kVideo, "FILE.mp4", VideoWriter::extensions(), "Write a video; .mp4, .mkv or .webm"},
          {kImages, "DIR", {}, "Write each frame as a PNG file into a folder"}};
}

std::unique_ptr<Observer> PictureOutput::create(const OutputPaths& paths) const {
  return std::make_unique<Pictures>(paths);
}

}  // namespace weir::rendering
