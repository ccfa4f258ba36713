#include "apps/studio/session/picture_desk.h"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include "apps/studio/session/carried_scene.h"
#include "framework/graph/guard.h"

namespace weir::studio {

namespace {

constexpr std::size_t kMaxVideoFrames = 2;  // that wait; then the simulation does
constexpr int kPainterNice = 15;

Error noPictures() {
  return ioError("this Weir cannot draw pictures: no plugin that does is loaded", "the plugin 'rendering'",
                 "'weir info' tells which plugins there are");
}

}  // namespace

std::string_view nameOf(VideoState state) {
  switch (state) {
    case VideoState::kNone:
      return "none";
    case VideoState::kRecording:
      return "recording";
    case VideoState::kFinishing:
      return "finishing";
    case VideoState::kDone:
      return "done";
    case VideoState::kFailed:
      return "failed";
  }
  return "failed";
}

PictureDesk::PictureDesk(const Registry& registry, std::function<void(VideoStatus)> told)
    : told_(std::move(told)) {
  auto services = registry.createServices<LivePictures>();
  if (!services.empty()) {
    pictures_ = std::move(services.front().implementation);
    source_ = services.front().source;
    callGuarded(
        source_, [&] { return hookText("pictures", "videoExtensions", source_); },
        [&] { extensions_ = pictures_->videoExtensions(); });
  }
  painter_ = std::thread([this] { paint(); });
}

PictureDesk::~PictureDesk() {
  {
    const std::lock_guard lock(mutex_);
    quit_ = true;
  }
  wake_.notify_all();
  painter_.join();
}

std::optional<Error> PictureDesk::problem() const {
  if (pictures_) return std::nullopt;
  return noPictures();
}

void PictureDesk::ask(ClientId client, const LivePictureOptions& options, bool newer, PictureDone done) {
  if (!pictures_) throw noPictures();
  const std::lock_guard lock(mutex_);
  Request& request = requests_[client];
  if (request.done) request.done({});
  request = {++asked_, options, newer, newer && latest_ && latest_->number > seen_[client], std::move(done)};
  wake_.notify_all();
}

void PictureDesk::forget(ClientId client) {
  const std::lock_guard lock(mutex_);
  requests_.erase(client);
  seen_.erase(client);
}

void PictureDesk::startVideo(std::filesystem::path file, const LivePictureOptions& options, std::string scene,
                             Begin begin) {
  if (!pictures_) throw noPictures();
  const std::lock_guard lock(mutex_);
  if (video_) throw usageError("a video is being made already", "one at a time", "stop it first");
  video_ = Video{.file = std::move(file), .options = options, .scene = std::move(scene), .begin = begin};
  status_ = {.state = VideoState::kRecording};
  tell(true);
}

void PictureDesk::moveCamera(const LiveCamera& camera) {
  const std::lock_guard lock(mutex_);
  if (video_) video_->options.camera = camera;
}

void PictureDesk::stopVideo() {
  const std::lock_guard lock(mutex_);
  if (video_ && !video_->ending) finishVideo();
}

void PictureDesk::finishVideo() {
  video_->ending = true;
  status_.state = VideoState::kFinishing;
  tell(true);
  wake_.notify_all();
  idle_.notify_all();
}

VideoStatus PictureDesk::video() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void PictureDesk::tell(bool always) {
  constexpr auto kEvery = std::chrono::milliseconds(250);
  const auto now = std::chrono::steady_clock::now();
  if (!always && now - toldAt_ < kEvery) return;
  toldAt_ = now;
  told_(status_);
}

std::optional<Error> PictureDesk::outside(Lock& lock, std::string_view hook,
                                          const std::function<void()>& f) const {
  constexpr bool kFilesSayEnough = true;
  std::optional<Error> problem;
  lock.unlock();
  try {
    callGuarded(
        source_, [&] { return hookText("pictures", hook, source_); }, f, kFilesSayEnough);
  } catch (const Error& e) {
    problem = e;
  } catch (const std::bad_alloc&) {
    problem = simulationError("out of memory");
  } catch (const std::exception& e) {
    problem = simulationError(std::string("a mistake in the program, please report it: ") + e.what());
  }
  lock.lock();
  return problem;
}

// The simulation's thread

bool PictureDesk::capture(Simulation& simulation, Lock& lock) {
  // The memory of an earlier copy that nobody looks at any more is used again.
  std::unique_ptr<Snapshot> snapshot;
  if (latest_.use_count() == 1 && !busy_)
    snapshot = std::move(std::const_pointer_cast<Held>(std::exchange(latest_, nullptr))->snapshot);
  auto held = std::make_shared<Held>();
  const auto problem = outside(lock, "capture", [&] {
    if (!renderer_) renderer_ = pictures_->open(simulation);
    held->snapshot = renderer_->capture(simulation, std::move(snapshot));
  });
  if (problem) {
    fail(*problem, lock);
    return false;
  }
  held->number = ++captured_;
  held->frame = simulation.frame();
  held->steps = simulation.stepsDone();
  held->time = simulation.time();
  latest_ = std::move(held);
  return true;
}

void PictureDesk::addToVideo(std::int64_t times) {
  if (!video_ || video_->ending) return;
  video_->frames.insert(video_->frames.end(), static_cast<std::size_t>(times), latest_);
  video_->hasFrames = true;
}

void PictureDesk::serve(Simulation* simulation) {
  Lock lock(mutex_);
  const bool wanted = std::any_of(requests_.begin(), requests_.end(), [](const auto& entry) {
    return !entry.second.newer && !entry.second.ready;
  });
  const bool begins = video_ && video_->begin == Begin::kNow && !video_->hasFrames && simulation != nullptr &&
                      simulation->atFrame();
  if (!wanted && !begins) return;
  if (simulation == nullptr)
    return fail(usageError("there is nothing to draw yet", {}, "play the scene, or reset it"), lock);
  // In the middle of a frame, one copy will do until the next.
  const bool isCurrent = latest_ && (latest_->steps == simulation->stepsDone() ||
                                     (!simulation->atFrame() && latest_->frame == simulation->frame()));
  if (!isCurrent && !capture(*simulation, lock)) return;
  if (begins) addToVideo();
  for (auto& [client, request] : requests_) request.ready = request.ready || !request.newer;
  wake_.notify_all();
}

void PictureDesk::frame(Simulation& simulation, std::int64_t times) {
  Lock lock(mutex_);
  idle_.wait(lock, [this] { return !video_ || video_->ending || video_->frames.size() < kMaxVideoFrames; });
  const bool recording = video_ && !video_->ending;
  if (!recording && requests_.empty()) return;
  if (!capture(simulation, lock)) return;
  addToVideo(times);
  for (auto& [client, request] : requests_) request.ready = true;
  wake_.notify_all();
}

void PictureDesk::leave() {
  Lock lock(mutex_);
  // Requests, and a video that has not begun, wait for the next simulation.
  if (video_ && video_->hasFrames && !video_->ending) finishVideo();
  idle_.wait(lock, [this] { return !busy_ && !(video_ && video_->ending); });
  for (auto& [client, request] : requests_) request.ready = false;
  latest_.reset();
  renderer_.reset();
}

void PictureDesk::change() {
  Lock lock(mutex_);
  // A picture that is being drawn has a copy of its own, and so have those of the video that wait.
  idle_.wait(lock, [this] { return nextRequest() == requests_.end(); });
  latest_.reset();
}

void PictureDesk::fail(const Error& problem) {
  Lock lock(mutex_);
  fail(problem, lock);
}

void PictureDesk::fail(const Error& problem, Lock& lock) {
  idle_.wait(lock, [this] { return !busy_; });
  for (const auto& [client, request] : requests_) request.done({.problem = problem});
  requests_.clear();
  if (video_) endVideo(VideoState::kFailed, problem);
  latest_.reset();
  renderer_.reset();
}

// The painter's thread

void PictureDesk::paint() {
  // Steps wait for the slowest of their threads, so whoever asks for pictures without end would slow all
  // down. Linux keeps a priority for each thread, and what a thread starts, as OSMesa and ffmpeg, inherits
  // it.
  [[maybe_unused]] const int nice = ::nice(kPainterNice);
  Lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return quit_ || videoHasWork() || nextRequest() != requests_.end(); });
    if (quit_) return;
    const auto request = nextRequest();
    // In turns, where there is both.
    videoWasLast_ = videoHasWork() && !(videoWasLast_ && request != requests_.end());
    busy_ = true;
    if (videoWasLast_)
      paintVideo(lock);
    else
      paintRequest(request, lock);
    busy_ = false;
    idle_.notify_all();
  }
}

bool PictureDesk::videoHasWork() const {
  return video_ && (video_->ending || !video_->frames.empty());
}

std::map<ClientId, PictureDesk::Request>::iterator PictureDesk::nextRequest() {
  auto first = requests_.end();
  for (auto i = requests_.begin(); latest_ && i != requests_.end(); ++i)
    if (i->second.ready && (first == requests_.end() || i->second.order < first->second.order)) first = i;
  return first;
}

void PictureDesk::paintRequest(std::map<ClientId, Request>::iterator which, Lock& lock) {
  const ClientId client = which->first;
  const Request request = std::move(which->second);
  requests_.erase(which);
  const HeldPointer held = latest_;
  seen_[client] = held->number;
  PictureAnswer answer{.jpeg = {}, .frame = held->frame, .time = held->time, .problem = {}};
  answer.problem =
      outside(lock, "draw", [&] { answer.jpeg = renderer_->draw(*held->snapshot, request.options); });
  request.done(std::move(answer));
}

void PictureDesk::paintVideo(Lock& lock) {
  Video& video = *video_;
  std::optional<Error> problem;
  if (video.frames.empty()) {
    if (video.started)
      problem = outside(lock, "finishVideo", [&] {
        renderer_->finishVideo();
        carryScene(video.file, video.scene);
      });
    return endVideo(problem ? VideoState::kFailed : VideoState::kDone, problem);
  }
  const HeldPointer held = video.frames.front();
  video.frames.pop_front();
  const LivePictureOptions options = video.options;
  problem = outside(lock, "addToVideo", [&] {
    if (!video.started) renderer_->startVideo(video.file, options.width, options.height);
    video.started = true;
    renderer_->addToVideo(*held->snapshot, options.camera.value_or(LiveCamera{}));
  });
  if (problem) return endVideo(VideoState::kFailed, problem);
  ++status_.frames;
  tell(false);
}

void PictureDesk::endVideo(VideoState state, std::optional<Error> problem) {
  video_.reset();
  status_.state = state;
  status_.problem = std::move(problem);
  tell(true);
}

}  // namespace weir::studio
