#include "plugins/rendering/picture_output.h"

#include <dlfcn.h>

#include <optional>

#include "framework/base/text.h"
#include "framework/run/stopwatch.h"
#include "plugins/rendering/gl/context.h"
#include "plugins/rendering/gl/renderer.h"
#include "plugins/rendering/output/image_sequence.h"
#include "plugins/rendering/output/video_writer.h"
#include "plugins/rendering/overlay/overlay.h"
#include "plugins/rendering/plot_history.h"
#include "plugins/rendering/scene_capture.h"
#include "plugins/rendering/scene_view.h"

namespace weir::rendering {

namespace {

constexpr const char* kVideo = "video";
constexpr const char* kImages = "images";

/// share/weir/fonts of the build or installation that this library is in: <prefix>/lib/weir/plugins.
std::filesystem::path fontFolder() {
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&fontFolder), &self) == 0) return {};
  return std::filesystem::absolute(self.dli_fname).parent_path() / "../../../share/weir/fonts";
}

/// Another device on the same machine, for another thread.
std::unique_ptr<Device> sibling(const Device& device) {
  const auto* cpu = dynamic_cast<const CpuDevice*>(&device);
  return openDevice(device.name(), cpu != nullptr ? cpu->threads() : 0);
}

/// A GPU that computes draws most pictures alone, because OpenGL may have few of its processors. Where OpenGL
/// is software, the device helps it.
std::unique_ptr<gl::Renderer> makeRenderer(const Device& device) {
  std::unique_ptr<gl::Context> context = gl::makeContext();
  if (device.kind() == DeviceKind::kCuda)
    return std::make_unique<gl::Renderer>(std::move(context), sibling(device), gl::ComputeShare::kWhatCanBe);
  std::unique_ptr<Device> helper = context->isSoftware() ? sibling(device) : nullptr;
  return std::make_unique<gl::Renderer>(std::move(context), std::move(helper));
}

template <class F>
decltype(auto) measured(double& seconds, F&& work) {
  const Stopwatch watch(seconds);
  return work();
}

class Pictures final : public Observer {
 public:
  explicit Pictures(const OutputPaths& paths) : paths_(paths) {}

  std::string name() const override { return "pictures"; }

  void begin(Simulation& simulation) override { begin(simulation, 0); }

  std::string_view stateName() const override { return "pictures"; }

  void save(const StateWriter& to) override {
    if (images_) images_->wait();
    to.put("frames", frames_);
    history_->save(to.in("plots"));
  }

  /// Pictures go on in the same folder. A video cannot be gone on with, so the rest of it is another one.
  void resume(Simulation& simulation, const StateReader& from) override {
    std::int64_t frames = 0;
    from.get("frames", frames);
    if (const auto path = paths_.find(kVideo); path != paths_.end()) {
      const std::filesystem::path whole = path->second;
      path->second.replace_filename(whole.stem().string() + ".from_" + std::to_string(frames) +
                                    whole.extension().string());
      simulation.log().warn("the frames from " + std::to_string(frames) + " on go to a video of their own, " +
                            inQuotes(path->second.string()));
    }
    begin(simulation, frames);
    history_->restore(from.in("plots"));
  }

  void begin(Simulation& simulation, std::int64_t firstFrame) {
    frames_ = firstFrame;
    const auto& settings = static_cast<const RenderSettings&>(*simulation.scene().sections.at("render"));
    settings_ = &settings;
    title_ = simulation.scene().title;
    capture_.emplace(settings);
    history_.emplace(settings.plots, simulation.scene().world.duration);
    // Made here, so that a machine without OpenGL is found out at once; current only where it is drawn with.
    renderer_ = makeRenderer(simulation.device());
    view_ = std::make_unique<SceneView>(settings, *renderer_);
    overlay_ = std::make_unique<Overlay>(fontFolder());
    if (const auto path = paths_.find(kVideo); path != paths_.end())
      video_.emplace(path->second, settings.width, settings.height, simulation.scene().world.frameRate);
    if (const auto path = paths_.find(kImages); path != paths_.end())
      images_.emplace(path->second, firstFrame);
  }

  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override {
    return capture_->at(simulation,
                        std::unique_ptr<SceneSnapshot>(static_cast<SceneSnapshot*>(used.release())));
  }

  void write(Snapshot& snapshot) override {
    auto& scene = static_cast<SceneSnapshot&>(snapshot);
    const View view = measured(viewing_, [&] { return view_->of(scene); });
    Picture picture = measured(drawing_, [&] { return renderer_->draw(view); });
    history_->add(scene.time, scene.plotted);
    measured(labelling_, [&] { overlay_->draw(overlayText(scene), picture); });
    measured(handingOver_, [&] { handOver(std::move(picture)); });
    ++frames_;
  }

  std::vector<OutputPart> writeParts() const override {
    return {{"view", viewing_}, {"draw", drawing_}, {"label", labelling_}, {"hand_over", handingOver_}};
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
  /// To those who encode it, on threads of their own; waits where they are slower.
  void handOver(Picture picture) {
    if (images_ && video_) images_->write(picture);
    if (images_ && !video_) images_->write(std::move(picture));
    if (video_) video_->write(std::move(picture));
  }

  OverlayText overlayText(const SceneSnapshot& scene) const {
    OverlayText text;
    text.lightText = wantsLightText(settings_->backgroundTop, settings_->backgroundBottom);
    if (settings_->overlay) {
      text.title = title_;
      text.seconds = scene.time;
      text.particles = scene.particles;
    }
    const ColorKey& key = view_->colorKey();
    const std::string caption = key.unit.empty() ? key.quantity : key.quantity + " in " + key.unit;
    text.plots = history_->plots();
    if (key.shown) text.bar = ColorBar{settings_->color->colorMap(), key.low, key.high, caption};
    return text;
  }

  OutputPaths paths_;
  const RenderSettings* settings_ = nullptr;
  std::string title_;
  std::optional<SceneCapture> capture_;
  // From here on what write() uses.
  double viewing_ = 0, drawing_ = 0, labelling_ = 0, handingOver_ = 0;  // s
  std::int64_t frames_ = 0;  // drawn, those of the run that is resumed included
  std::unique_ptr<gl::Renderer> renderer_;
  std::unique_ptr<SceneView> view_;
  std::unique_ptr<Overlay> overlay_;
  std::optional<PlotHistory> history_;
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
