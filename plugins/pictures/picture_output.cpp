#include "plugins/pictures/picture_output.h"

#include <optional>

#include "framework/base/build_info.h"
#include "framework/base/text.h"
#include "framework/run/output_worker.h"
#include "framework/run/stopwatch.h"
#include "framework/scene/scene_file.h"
#include "plugins/cycles/cycles_renderer.h"
#include "plugins/pictures/composited_frames.h"
#include "plugins/pictures/overlay_text.h"
#include "plugins/rendering/make_renderer.h"
#include "plugins/video/frame_ledger.h"
#include "plugins/video/growing_video.h"
#include "plugins/video/image_file.h"
#include "plugins/video/image_sequence.h"
#include "plugins/video/saved_video.h"
#include "plugins/video/video_writer.h"
#include "plugins/views/plot_history.h"
#include "plugins/views/scene_capture.h"
#include "plugins/views/scene_view.h"

namespace weir::rendering {

namespace {

constexpr const char* kVideo = "video";
constexpr const char* kImages = "images";

template <class F>
decltype(auto) measured(double& seconds, F&& work) {
  const Stopwatch watch(seconds);
  return work();
}

/// What one camera sees. All but write() and writeParts() are called as an Observer's.
class Pictures {
 public:
  /// By the first camera, or by one of the others; of particles, or of what ranks have found of theirs.
  Pictures(OutputPaths paths, bool ofRanks, std::optional<std::size_t> camera = std::nullopt)
      : paths_(std::move(paths)), ofRanks_(ofRanks), camera_(camera) {}

  /// A replay may begin anywhere.
  void begin(Simulation& simulation) {
    begin(simulation, simulation.isReplay() ? simulation.frame() : 0, std::nullopt);
  }

  void save(const StateWriter& to) {
    if (images_) images_->wait();
    to.put("frames", frames_);
    history_->save(to.in("plots"));
    if (!video_) return;
    video_->save();
    saveVideo(video_->state(), to.in(kVideo));
  }

  void resume(Simulation& simulation, const StateReader& from) {
    std::int64_t frames = 0;
    from.get("frames", frames);
    const std::optional<VideoState> earlier = savedVideo(from.in(kVideo));
    if (!earlier && frames > 0 && paths_.contains(kVideo))
      simulation.log().warn("the video begins with frame " + std::to_string(frames) +
                            ", as the checkpoint is of a run without one");
    begin(simulation, frames, earlier);
    history_->restore(from.in("plots"));
  }

  void begin(Simulation& simulation, std::int64_t firstFrame, const std::optional<VideoState>& earlier) {
    frames_ = firstFrame;
    const auto& settings = static_cast<const RenderSettings&>(*simulation.scene().sections.at("render"));
    settings_ = &settings;
    title_ = simulation.scene().title;
    history_.emplace(settings.plots, simulation.scene().world.duration);
    makeRenderers(simulation);
    overlay_ = std::make_unique<Overlay>(fontFolder());
    if (const auto path = paths_.find(kVideo); path != paths_.end())
      startVideo(path->second, simulation.scene(), earlier);
    if (const auto path = paths_.find(kImages); path != paths_.end())
      images_.emplace(path->second, firstFrame);
    if (!images_) return;
    if (!simulation.isReplay() && settings.engine != PictureEngine::kCycles) {
      FrameLedger::remove(paths_.at(kImages));
    } else {
      ledger_.emplace(paths_.at(kImages));
      made_.emplace().add(version());
      made_->add(writeJson(sceneToValue(simulation.scene())));
      addFiles();
    }
  }

  void write(SceneSnapshot& scene) {
    frames_ = scene.frame;
    if (made_) addStill(scene);
    // What the pictures are made of is looked at on the host.
    const ParticlePlace place = made_ ? ParticlePlace::kHost : ParticlePlace::kWhereTheyAreDrawn;
    const View view = measured(viewing_, [&] { return view_->of(scene, place); });
    history_->add(scene.time, scene.plotted);
    if (!made_ || !isThere(scene, view))
      draw(scene, view_->colorKey(), [&] { return renderer_->draw(view); });
    ++frames_;
  }

  void write(const SceneSnapshot& scene, const CompositedFrame::Picture& of) {
    frames_ = scene.frame;
    history_->add(scene.time, scene.plotted);
    draw(scene, of.key, [&] { return compositor_->draw(of.view, of.seen); });
    ++frames_;
  }

  std::vector<OutputPart> writeParts() const {
    return {{"view", viewing_}, {"draw", drawing_}, {"label", labelling_}, {"hand_over", handingOver_}};
  }

  void end(Simulation& simulation) {
    if (images_) {
      if (there_ > 0 && images_->frameCount() != frames_) skipImages();
      images_->finish();
      if (there_ > 0)
        simulation.log().info(std::to_string(there_) + " pictures were there and have not been drawn again");
      if (const std::string leftovers = images_->leftovers(); !leftovers.empty())
        simulation.log().warn(leftovers);
    }
    if (video_) video_->finish();
  }

 private:
  void startVideo(const std::filesystem::path& file, const Scene& scene,
                  const std::optional<VideoState>& earlier) {
    const VideoSettings& video = *settings_->video;
    const VideoFormat format = video.format(settings_->transparent);
    frameRate_ = scene.world.frameRate;
    try {
      checkFormat(file, format);
    } catch (Error& error) {
      if (error.kind() != ErrorKind::kScene) throw;
      throw error.at({.file = scene.file, .pointer = "/render/video/codec"});
    }
    video_.emplace(file, VideoSize{settings_->width, settings_->height, video.videoRate(frameRate_)}, format,
                   earlier);
  }

  /// As often as the video's rate asks for.
  void addToVideo(Picture picture) {
    const std::int64_t times = settings_->video->timesShown(frames_, frameRate_);
    for (std::int64_t i = 1; i < times; ++i) video_->write(picture);
    if (times > 0) video_->write(std::move(picture));
  }

  template <class F>
  void draw(const SceneSnapshot& scene, const ColorKey& key, const F& drawn) {
    Picture picture = measured(drawing_, drawn);
    if (!picture.isWhole()) return;  // interrupted
    measured(labelling_, [&] {
      overlay_->draw(overlayText(*settings_, title_, scene, key, map_, history_->plots()), picture);
    });
    measured(handingOver_, [&] { handOver(std::move(picture)); });
  }

  /// To those who encode it, on threads of their own; waits where they are slower.
  void handOver(Picture picture) {
    if (images_ && images_->frameCount() != frames_) skipImages();
    if (images_ && video_) images_->write(picture);
    if (images_ && !video_) images_->write(std::move(picture));
    if (video_) addToVideo(std::move(picture));
  }

  /// At the start, so that a machine without OpenGL or Blender is found out at once; current only where it is
  /// drawn with.
  void makeRenderers(const Simulation& simulation) {
    map_ = settings_->color->colorMap();
    if (ofRanks_) {
      device_ = siblingOf(simulation.device());
      compositor_.emplace(*device_);
      return;
    }
    renderer_ = makeMaker(simulation);
    view_ = std::make_unique<SceneView>(*settings_, cameraOf(*settings_), *renderer_);
  }

  std::unique_ptr<PictureMaker> makeMaker(const Simulation& simulation) const {
    if (settings_->engine == PictureEngine::kWeir) return makeRenderer(simulation.device());
    return std::make_unique<CyclesRenderer>(siblingOf(simulation.device()), *settings_->cycles,
                                            simulation.scene().world.frameRate);
  }

  const CameraSettings& cameraOf(const RenderSettings& settings) const {
    if (camera_) return settings.cameras[*camera_];
    return *settings.camera;
  }

  /// What files hold that the scene names.
  void addFiles() {
    constexpr int kColors = 256;
    for (int i = 0; i < kColors && !settings_->color->file->empty(); ++i) {
      const Vec3f color = map_.at(static_cast<float>(i) / (kColors - 1));
      made_->addAll(std::span(&color, 1));
    }
    if (const EnvironmentImage* image = view_->surroundings())
      made_->addAll(std::span<const Vec3f>(image->light));
  }

  void addStill(const SceneSnapshot& scene) {
    if (!scene.still) return;
    for (const StillScene::Surface& surface : scene.still->surfaces)
      made_->addAll(std::span<const Vec3f>(surface.mesh.vertices));
  }

  /// Of a replay: whether the picture of this frame need not be drawn. All frames before it belong to what it
  /// is made of, as colours and cameras follow what was seen so far.
  bool isThere(SceneSnapshot& scene, const View& view) {
    made_->addAll(std::span<const double>(&scene.time, 1));
    for (const ParticleView& particles : view.particles) {
      made_->addAll(particles.positions);
      made_->addAll(particles.values);
      made_->addAll(particles.radii);
    }
    for (FluidSurfaceSnapshot& surface : scene.fluidSurfaces) made_->addAll(surface.mesh.wait().vertices);
    made_->addAll(std::span<const Pose>(scene.poses));
    const std::uint64_t digest = made_->value();
    if (!ledger_->has(frames_, digest)) {
      ledger_->note(frames_, digest);
      return false;
    }
    if (video_) {
      std::optional<Picture> picture = pictureThere();
      if (!picture) return false;
      addToVideo(std::move(*picture));
    }
    ++there_;
    return true;
  }

  std::optional<Picture> pictureThere() const {
    try {
      return readPng(paths_.at(kImages) / ImageSequence::nameOf(frames_));
    } catch (const Error&) {
      return std::nullopt;  // damaged: it is drawn again
    }
  }

  /// Images go on with the next frame, behind some that were there.
  void skipImages() {
    images_->finish();
    images_.emplace(paths_.at(kImages), frames_);
  }

  OutputPaths paths_;
  bool ofRanks_;
  std::optional<std::size_t> camera_;
  const RenderSettings* settings_ = nullptr;
  std::string title_;
  // From here on what write() uses.
  double viewing_ = 0, drawing_ = 0, labelling_ = 0, handingOver_ = 0;  // s
  double frameRate_ = 0;                                                // of the run, where there is a video
  std::int64_t frames_ = 0;  // those before the one that is drawn, or is to be drawn next
  std::unique_ptr<PictureMaker> renderer_;
  std::unique_ptr<SceneView> view_;
  // In place of these, of ranks.
  std::unique_ptr<Device> device_;
  std::optional<ComputeRenderer> compositor_;
  ColorMap map_;
  std::unique_ptr<Overlay> overlay_;
  std::optional<PlotHistory> history_;
  std::optional<GrowingVideo> video_;
  std::optional<ImageSequence> images_;
  // Of replays with images alone.
  std::optional<FrameLedger> ledger_;
  std::optional<Digest> made_;  // of all that the pictures so far are made of
  std::int64_t there_ = 0;      // that have not been drawn again
};

/// What all cameras of a scene see: each has pictures of its own, of one copy of the frame. On ranks above 0
/// there are none, and frames are found alone.
class SeveralCameras final : public Observer {
 public:
  explicit SeveralCameras(const OutputPaths& paths, Communicator* ranks = nullptr)
      : paths_(paths), ranks_(ranks) {}

  std::string name() const override { return "pictures"; }
  std::string_view stateName() const override { return "pictures"; }

  void begin(Simulation& simulation) override {
    start(simulation, [&](Pictures& pictures, const std::string&) { pictures.begin(simulation); });
  }
  void save(const StateWriter& to) override {
    for (const Camera& camera : cameras_) camera.pictures->save(stateOf(to, camera.name));
  }
  void resume(Simulation& simulation, const StateReader& from) override {
    start(simulation, [&](Pictures& pictures, const std::string& camera) {
      const StateReader state = stateOf(from, camera);
      if (state.has("frames")) return pictures.resume(simulation, state);
      pictures.begin(simulation);  // a camera that the run did not have
    });
  }

  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override {
    if (ranks_ != nullptr) return composited_->at(simulation);
    return capture_->at(simulation,
                        std::unique_ptr<SceneSnapshot>(static_cast<SceneSnapshot*>(used.release())));
  }
  void write(Snapshot& snapshot) override {
    if (ranks_ != nullptr) return writeComposited(static_cast<const CompositedFrame&>(snapshot));
    for (const Camera& camera : cameras_) camera.pictures->write(static_cast<SceneSnapshot&>(snapshot));
  }
  std::vector<OutputPart> writeParts() const override {
    std::vector<OutputPart> sums;
    for (const Camera& camera : cameras_) {
      const std::vector<OutputPart> parts = camera.pictures->writeParts();
      if (sums.empty()) sums.resize(parts.size());
      for (std::size_t i = 0; i < parts.size(); ++i)
        sums[i] = {parts[i].name, sums[i].seconds + parts[i].seconds};
    }
    return sums;
  }

  void end(Simulation& simulation, RunEnd) override {
    FirstError errors;
    for (const Camera& camera : cameras_) {
      try {
        camera.pictures->end(simulation);
      } catch (...) {
        errors.keepCurrent();  // the others must be completed, too
      }
    }
    errors.rethrowIfAny();
  }

 private:
  struct Camera {
    std::string name;  ///< "" for the first one
    std::unique_ptr<Pictures> pictures;
  };

  /// run.mp4 becomes run.NAME.mp4, and a folder the one of that name in it.
  static OutputPaths pathsOf(OutputPaths paths, const std::string& camera) {
    if (const auto video = paths.find(kVideo); video != paths.end())
      video->second.replace_filename(video->second.stem().string() + "." + camera +
                                     video->second.extension().string());
    if (const auto images = paths.find(kImages); images != paths.end()) images->second /= camera;
    return paths;
  }

  template <class State>
  static State stateOf(const State& state, const std::string& camera) {
    return camera.empty() ? state : state.in("cameras").in(camera);
  }

  void writeComposited(const CompositedFrame& frame) const {
    for (std::size_t i = 0; i < cameras_.size(); ++i)
      cameras_[i].pictures->write(frame.scene, frame.pictures[i]);
  }

  /// The first one first: the folders of the others are in its folder.
  template <class F>
  void start(const Simulation& simulation, const F& begin) {
    const auto& settings = static_cast<const RenderSettings&>(*simulation.scene().sections.at("render"));
    const bool byCycles = settings.engine == PictureEngine::kCycles;
    if (ranks_ != nullptr) composited_.emplace(settings, simulation, *ranks_);
    capture_.emplace(settings, CaptureNeeds{.velocities = byCycles && settings.cycles->shutter > 0,
                                            .closedWater = byCycles});
    cameras_.clear();
    if (ranks_ != nullptr && ranks_->rank() > 0) return;
    const bool ofRanks = ranks_ != nullptr;
    cameras_.push_back({"", std::make_unique<Pictures>(paths_, ofRanks)});
    for (std::size_t i = 0; i < settings.cameras.size(); ++i) {
      const std::string& camera = settings.cameras[i].name;
      cameras_.push_back({camera, std::make_unique<Pictures>(pathsOf(paths_, camera), ofRanks, i)});
    }
    for (Camera& camera : cameras_) begin(*camera.pictures, camera.name);
  }

  OutputPaths paths_;
  Communicator* ranks_;
  std::optional<SceneCapture> capture_;
  std::optional<CompositedFrames> composited_;  // in its place, on ranks
  std::vector<Camera> cameras_;
};

}  // namespace

std::vector<OutputOption> PictureOutput::options() const {
  return {{kVideo, "FILE.mp4", videoExtensions(), "Write a video; .mp4, .mkv, .webm, .mov (ProRes) or .gif"},
          {kImages, "DIR", {}, "Write each frame as a PNG file into a folder"}};
}

std::unique_ptr<Observer> PictureOutput::create(const OutputPaths& paths) const {
  return std::make_unique<SeveralCameras>(paths);
}

bool PictureOutput::isAsked(const Scene& scene) const {
  return canBeComposited(scene);
}

std::unique_ptr<Observer> PictureOutput::create(const OutputPaths& paths, Communicator& ranks) const {
  return std::make_unique<SeveralCameras>(paths, &ranks);
}

}  // namespace weir::rendering
