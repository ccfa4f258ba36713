#include "apps/studio/session/simulation_host.h"

#include <algorithm>
#include <utility>

#include "framework/run/statistics.h"

namespace weir::studio {

namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr auto kStatusEvery = std::chrono::milliseconds(100);
constexpr auto kNumbersEvery = std::chrono::milliseconds(250);
constexpr int kNumbersShare = 100;  // they take at most one part of so many of the time

bool isTime(SteadyClock::time_point& last, SteadyClock::duration every) {
  const SteadyClock::time_point now = SteadyClock::now();
  if (now - last < every) return false;
  last = now;
  return true;
}

}  // namespace

std::string_view nameOf(HostState state) {
  switch (state) {
    case HostState::kEmpty:
      return "empty";
    case HostState::kBuilding:
      return "building";
    case HostState::kPaused:
      return "paused";
    case HostState::kPlaying:
      return "playing";
    case HostState::kFinished:
      return "finished";
    case HostState::kFailed:
      return "failed";
  }
  return "failed";
}

SimulationHost::SimulationHost(const Registry& registry, Log& log, HostListener& listener, int threads)
    : registry_(registry), log_(log), listener_(listener), threads_(threads), thread_([this] { work(); }) {}

SimulationHost::~SimulationHost() {
  quit_ = true;
  post([] {});
  thread_.join();
}

void SimulationHost::post(Task task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
    stop_ = true;
  }
  wake_.notify_one();
}

void SimulationHost::load(std::unique_ptr<Scene> scene, std::string device) {
  // A std::function must be copyable.
  post([this, scene = std::make_shared<std::unique_ptr<Scene>>(std::move(scene)), device = std::move(device),
        number = ++loads_] {
    if (number == loads_) takeScene(std::move(*scene), device);
  });
}
void SimulationHost::play() {
  post([this] { go(std::nullopt); });
}
void SimulationHost::pause() {
  post([this] {
    if (state_ == HostState::kPlaying) tell(HostState::kPaused);
  });
}
void SimulationHost::reset() {
  post([this] { resetNow(); });
}
void SimulationHost::advance(std::int64_t frames) {
  post([this, frames] {
    if (!simulation_) return;
    // Frames that were asked for before and are still to come count: one press, one frame.
    const bool advancing = state_ == HostState::kPlaying && pauseAt_;
    go((advancing ? *pauseAt_ : simulation_->frame()) + frames);
  });
}
void SimulationHost::change(std::vector<LiveChange> changes) {
  post([this, changes = std::move(changes)] {
    if (!simulation_) return;
    for (const LiveChange& change : changes) apply(change, simulation_->scene());
  });
}
void SimulationHost::show(FrameView view) {
  post([this, view = std::move(view)] {
    view_ = view;
    if (simulation_ && simulation_->atFrame()) tellFrame();
  });
}
void SimulationHost::ask(std::function<void(Simulation*)> f) {
  post([this, f = std::move(f)] { f(simulation_.get()); });
}

void SimulationHost::work() {
  while (!quit_) {
    guarded([this] { runTasks(); });
    if (state_ == HostState::kPlaying && !quit_) guarded([this] { advanceNow(); });
  }
  listener_.leaving();
}

void SimulationHost::runTasks() {
  std::deque<Task> tasks;
  {
    std::unique_lock lock(mutex_);
    if (state_ != HostState::kPlaying) wake_.wait(lock, [this] { return !tasks_.empty(); });
    tasks.swap(tasks_);
    stop_ = false;
  }
  for (const Task& task : tasks) guarded(task);
}

void SimulationHost::guarded(const std::function<void()>& f) {
  try {
    f();
    return;
  } catch (const Error& e) {
    problem_ = problemOf(e);
    log_.error(e.what());
  } catch (const std::bad_alloc&) {
    problem_ = problemOf(simulationError("out of memory"));
  } catch (const std::exception& e) {
    problem_ =
        problemOf(simulationError(std::string("a mistake in the program, please report it: ") + e.what()));
  }
  tell(HostState::kFailed);
}

void SimulationHost::takeScene(std::unique_ptr<Scene> scene, const std::string& device) {
  // The old simulation gives its memory back first.
  listener_.leaving();
  frames_.reset();
  simulation_.reset();
  tell(HostState::kBuilding);
  if (!device_ || device != deviceName_) device_ = openDevice(device, threads_);
  deviceName_ = device;
  deviceDescription_ = device_->description();  // which it asks the system for
  simulation_ = std::make_unique<Simulation>(std::move(scene), *device_, log_, registry_);
  resetNow();
}

void SimulationHost::resetNow() {
  if (!simulation_) return;
  problem_.reset();
  pauseAt_.reset();
  // A fluid that comes to rest first takes its time.
  if (state_ != HostState::kBuilding) tell(HostState::kBuilding);
  try {
    simulation_->reset();
  } catch (...) {
    frames_.reset();
    simulation_.reset();  // nobody may look at half a scene
    throw;
  }
  listener_.geometry(geometryPacket(*simulation_));
  tell(HostState::kPaused);
  frameReached();
}

void SimulationHost::go(std::optional<std::int64_t> pauseAt) {
  if (!simulation_ || state_ == HostState::kFailed) return;
  pauseAt_ = pauseAt;
  const bool atEnd = simulation_->frame() >= simulation_->clock().frameCount();
  tell(atEnd ? HostState::kFinished : HostState::kPlaying);
}

void SimulationHost::advanceNow() {
  // At least one step between tasks, however many of them come.
  std::atomic<bool> stop = false;
  const auto afterStep = [&] {
    stop = stop_.load();
    if (isTime(told_, kStatusEvery)) listener_.status(status());
  };
  if (!simulation_->advanceFrame(stop, afterStep)) return;  // a task waits
  frameReached();
  if (simulation_->frame() >= simulation_->clock().frameCount())
    tell(HostState::kFinished);
  else if (pauseAt_ && simulation_->frame() >= *pauseAt_)
    tell(HostState::kPaused);
}

void SimulationHost::frameReached() {
  tellFrame();
  listener_.reached(*simulation_);
  if (SteadyClock::now() - counted_ >=
      std::max<SteadyClock::duration>(kNumbersEvery, kNumbersShare * counting_))
    tellNumbers();
  if (isTime(told_, kStatusEvery)) listener_.status(status());
}

void SimulationHost::tellFrame() {
  if (!frames_) frames_.emplace(*device_);
  listener_.frame(simulation_->frame(), frames_->make(*simulation_, view_));
}

void SimulationHost::tellNumbers() {
  const SteadyClock::time_point start = SteadyClock::now();
  listener_.numbers(runStatistics(*simulation_, RunEnd::kInterrupted));
  counted_ = SteadyClock::now();
  counting_ = counted_ - start;
}

void SimulationHost::tell(HostState state) {
  state_ = state;
  told_ = SteadyClock::now();
  listener_.status(status());
  // What one looks at when it stands still is the last frame's.
  const bool stands = state == HostState::kPaused || state == HostState::kFinished;
  if (stands && simulation_ && simulation_->atFrame()) tellNumbers();
}

Value SimulationHost::status() {
  Value v = Value::object();
  v["state"] = nameOf(state_);
  if (simulation_) {
    v["device"] = deviceDescription_;
    v["frame"] = simulation_->frame();
    v["frames"] = simulation_->clock().frameCount();
    v["time"] = simulation_->time();
    v["duration"] = simulation_->scene().world.duration.get();
    v["steps"] = simulation_->stepsDone();
    v["particles"] = simulation_->particleCount();
    v["stepping_seconds"] = simulation_->stepSeconds();
    busy_.take(SteadyClock::now(), simulation_->stepSeconds());
    v["device_busy"] = state_ == HostState::kPlaying ? busy_.share() : 0;
  }
  if (problem_) v["problem"] = *problem_;
  return v;
}

}  // namespace weir::studio
