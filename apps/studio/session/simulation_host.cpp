#include "apps/studio/session/simulation_host.h"

#include <algorithm>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/interruption.h"
#include "framework/graph/memory_estimate.h"
#include "framework/run/statistics.h"

namespace weir::studio {

namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr auto kStatusEvery = std::chrono::milliseconds(100);
constexpr int kAnswersShare = 40;  // answers to questions take at most one part in kAnswersShare of the time
constexpr int kStatesShare = 50;   // and so do the states to go on from

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

SimulationHost::SimulationHost(const Registry& registry, Log& log, HostListener& listener, int threads,
                               std::int64_t maxStateBytes)
    : registry_(registry),
      log_(log),
      listener_(listener),
      threads_(threads),
      maxStateBytes_(maxStateBytes),
      states_(maxStateBytes),
      past_(
          registry, threads, [this] { listener_.pastChanging(); }, [this] { listener_.pastLeaving(); }),
      thread_([this] { work(); }) {}

SimulationHost::~SimulationHost() {
  quit_ = true;
  order([this](RunOrders&) { replaced_ = true; });
  thread_.join();
}

void SimulationHost::order(const std::function<void(RunOrders&)>& add) {
  {
    const std::lock_guard lock(mutex_);
    add(orders_);
    ordered_ = true;
  }
  wake_.notify_one();
}

void SimulationHost::load(std::unique_ptr<Scene> scene, std::unique_ptr<Scene> again, std::string device) {
  order([&](RunOrders& orders) {
    orders.addLoad({std::move(scene), std::move(device), std::move(again)});
    replaced_ = true;
  });
}
void SimulationHost::goOn(std::unique_ptr<Scene> scene, std::unique_ptr<Scene> again, std::string device,
                          std::int64_t frame) {
  order([&](RunOrders& orders) {
    orders.addLoad({std::move(scene), std::move(device), std::move(again), frame});
    replaced_ = true;
  });
}
void SimulationHost::play() {
  order([](RunOrders& orders) { orders.addPlay(); });
}
void SimulationHost::pause() {
  order([](RunOrders& orders) { orders.addPause(); });
}
void SimulationHost::advance(std::int64_t frames) {
  order([&](RunOrders& orders) { orders.frames += frames; });
}
void SimulationHost::change(std::vector<LiveChange> changes) {
  order([&](RunOrders& orders) { orders.addChanges(std::move(changes)); });
}
void SimulationHost::pull(BodyWish wish) {
  order([&](RunOrders& orders) { orders.addPull(std::move(wish)); });
}
void SimulationHost::release() {
  order([](RunOrders& orders) { orders.addRelease(); });
}
void SimulationHost::show(FrameView view) {
  order([&](RunOrders& orders) { orders.view = std::move(view); });
}
void SimulationHost::serve() {
  order([](RunOrders& orders) { orders.serve = true; });
}
void SimulationHost::replay() {
  order([](RunOrders& orders) { orders.replay = true; });
}

bool SimulationHost::ask(std::uint64_t client, QuestionQueue::Question f) {
  {
    const std::lock_guard lock(mutex_);
    if (!questions_.add(client, std::move(f))) return false;
    asked_ = true;
  }
  wake_.notify_one();
  return true;
}

void SimulationHost::forget(std::uint64_t client) {
  const std::lock_guard lock(mutex_);
  questions_.forget(client);
  asked_ = !questions_.empty();
}

void SimulationHost::work() {
  while (!quit_) {
    RunOrders orders = takeOrders();
    if (quit_) break;
    guarded([&] { obey(std::move(orders)); });
    guarded([this] { answerOne(); });
    guarded([this] { advanceReplay(); });
    if (state_ == HostState::kPlaying && !quit_) guarded([this] { advanceNow(); });
  }
  past_.begin(nullptr, {});
  listener_.leaving();
}

RunOrders SimulationHost::takeOrders() {
  std::unique_lock lock(mutex_);
  if (state_ != HostState::kPlaying && !replay_)
    wake_.wait(lock, [this] { return ordered_ || !questions_.empty(); });
  ordered_ = replaced_ = false;
  return std::exchange(orders_, {});
}

void SimulationHost::obey(RunOrders orders) {
  if (orders.serveFirst) listener_.serve(simulation_.get());
  if (orders.replay) beginReplay();
  if (orders.view) view_ = *orders.view;
  if (orders.load) takeScene(std::move(*orders.load));
  if (simulation_)
    for (const LiveChange& change : orders.changes) apply(change, simulation_->scene());
  if (orders.release && simulation_) pull_.release(*simulation_);
  if (orders.pull && simulation_) pull_.pull(*simulation_, std::move(*orders.pull));
  if (orders.view && !orders.load && simulation_ && simulation_->atFrame()) tellFrame();
  if (orders.serve) listener_.serve(simulation_.get());
  if (orders.pause && state_ == HostState::kPlaying) tell(HostState::kPaused);
  if (orders.play) go(std::nullopt);
  if (orders.frames > 0) advanceBy(orders.frames);
}

void SimulationHost::advanceBy(std::int64_t frames) {
  if (!simulation_) return;
  // Frames that were asked for before and are still to come count: one press, one frame.
  const bool advancing = state_ == HostState::kPlaying && pauseAt_;
  go((advancing ? *pauseAt_ : simulation_->frame()) + frames);
}

bool SimulationHost::mayAnswer() const {
  return state_ != HostState::kPlaying || SteadyClock::now() >= nextAnswer_;
}

void SimulationHost::answerOne() {
  if (!asked_ || !mayAnswer()) return;
  QuestionQueue::Question question;
  {
    const std::lock_guard lock(mutex_);
    if (questions_.empty()) return;
    question = questions_.next();
    asked_ = !questions_.empty();
  }
  const SteadyClock::time_point start = SteadyClock::now();
  question(simulation_.get());
  const SteadyClock::time_point end = SteadyClock::now();
  nextAnswer_ = end + kAnswersShare * (end - start);
}

Simulation& SimulationHost::runAt(std::int64_t frame) {
  WEIR_CHECK(simulation_ != nullptr);
  if (simulation_->atFrame() && simulation_->frame() == frame) return *simulation_;
  const RunState state = states_.nearest(frame);
  if (!state)
    throw usageError("no frame of this run is kept whole: one would take more memory than the " +
                         shortBytes(static_cast<double>(maxStateBytes_)) + " that there are for it",
                     {}, "start the studio with a larger --frames-mb");
  return past_.at(state);
}

void SimulationHost::guarded(const std::function<void()>& f) {
  try {
    f();
    return;
  } catch (const Error& e) {
    problem_ = problemOf(e);
    log_.error(e.what());
  } catch (const Interrupted&) {
    if (replaced_) return;
    problem_ = problemOf(simulationError("the scene was not set up, as the studio ends"));
  } catch (const std::bad_alloc&) {
    problem_ = problemOf(simulationError("out of memory"));
  } catch (const std::exception& e) {
    problem_ =
        problemOf(simulationError(std::string("a mistake in the program, please report it: ") + e.what()));
  }
  tell(HostState::kFailed);
}

void SimulationHost::takeScene(RunOrders::Load load) {
  const RunState from = load.from ? states_.lastUpTo(*load.from) : nullptr;
  endReplay(std::nullopt);
  // The old simulation gives its memory back first.
  listener_.leaving();
  past_.begin(std::move(load.again), load.device);
  frames_.reset();
  pull_.forget();
  simulation_.reset();
  problem_.reset();
  pauseAt_.reset();
  if (!from) {
    states_.clear();
    keeping_ = {};  // its first frame is kept, however short ago it is that another run's was
  }
  if (!load.scene) return tell(HostState::kEmpty);
  tell(HostState::kBuilding);
  if (!device_ || load.device != deviceName_) device_ = openDevice(load.device, threads_);
  deviceName_ = load.device;
  deviceDescription_ = device_->description();  // which it asks the system for
  build(std::move(load.scene), from);
  if (!from) listener_.geometry(geometryPacket(*simulation_));
  states_.forgetAfter(simulation_->frame());
  if (from) listener_.wentBack(simulation_->frame());
  tell(HostState::kPaused);
  frameReached();
}

void SimulationHost::build(std::unique_ptr<Scene> scene, const RunState& from) {
  const InterruptibleWork work(&replaced_);
  simulation_ = std::make_unique<Simulation>(std::move(scene), *device_, log_, registry_);
  simulation_->onSetUp([this](std::string_view node, std::size_t done, std::size_t all) {
    building_ = Value::object();
    (*building_)["node"] = node;
    (*building_)["done"] = static_cast<std::int64_t>(done);
    (*building_)["all"] = static_cast<std::int64_t>(all);
    listener_.status(status());
  });
  try {
    if (from)
      simulation_->resume(StateReader(*from));
    else
      simulation_->reset();
    building_.reset();
  } catch (...) {
    building_.reset();
    frames_.reset();
    simulation_.reset();  // nobody may look at half a scene
    throw;
  }
}

void SimulationHost::go(std::optional<std::int64_t> pauseAt) {
  if (!simulation_ || state_ == HostState::kFailed) return;
  pauseAt_ = pauseAt;
  const bool atEnd = simulation_->frame() >= simulation_->clock().frameCount();
  tell(atEnd ? HostState::kFinished : HostState::kPlaying);
}

void SimulationHost::advanceNow() {
  // At least one step between orders, and between questions, however many of them come.
  std::atomic<bool> stop = false;
  const auto afterStep = [&] {
    pull_.update(*simulation_);
    stop = ordered_ || (asked_ && mayAnswer());
    if (isTime(told_, kStatusEvery)) listener_.status(status());
  };
  if (!simulation_->advanceFrame(stop, afterStep)) return;  // somebody waits
  frameReached();
  if (simulation_->frame() >= simulation_->clock().frameCount())
    tell(HostState::kFinished);
  else if (pauseAt_ && simulation_->frame() >= *pauseAt_)
    tell(HostState::kPaused);
}

void SimulationHost::frameReached() {
  tellFrame();
  listener_.reached(*simulation_);
  keepState();
  if (numbersPace_.isDue(SteadyClock::now())) tellNumbers();
  if (isTime(told_, kStatusEvery)) listener_.status(status());
}

void SimulationHost::keepState() {
  constexpr std::int64_t kLeastBytes = 36;  // of a particle: its position, velocity, id and two more numbers
  const SteadyClock::time_point start = SteadyClock::now();
  if (simulation_->frame() % states_.every() != 0 || start - kept_ < kStatesShare * keeping_) return;
  if (simulation_->particleCount() > maxStateBytes_ / kLeastBytes) return;
  // One alone that is too large would be kept for want of another.
  if (RunState kept = presentState(); bytesOf(kept) <= maxStateBytes_)
    states_.add(simulation_->frame(), std::move(kept));
  kept_ = SteadyClock::now();
  keeping_ = kept_ - start;
}

RunState SimulationHost::presentState() const {
  auto state = std::make_shared<StateArrays>();
  simulation_->save(StateWriter(*state));
  return state;
}

void SimulationHost::beginReplay() {
  if (!simulation_) return listener_.replayEnded(usageError("there is no run to look back at"));
  const std::int64_t last = simulation_->frame();
  replay_ = Replay{.next = 0, .last = last, .present = {}};
  if (simulation_->atFrame() && !states_.has(last)) replay_->present = presentState();
}

std::optional<std::pair<std::int64_t, RunState>> SimulationHost::nextOfReplay(std::int64_t from) const {
  const auto kept = states_.firstFrom(from);
  if (kept && kept->first <= replay_->last) return kept;
  if (replay_->present && from <= replay_->last) return std::pair(replay_->last, replay_->present);
  return std::nullopt;
}

void SimulationHost::advanceReplay() {
  if (!replay_ || !mayAnswer()) return;
  const auto shown = nextOfReplay(replay_->next);
  if (!shown) return endReplay(std::nullopt);
  const auto following = nextOfReplay(shown->first + 1);
  const std::int64_t next = following ? following->first : replay_->last + 1;
  const SteadyClock::time_point start = SteadyClock::now();
  bool wanted = false;
  try {
    wanted = listener_.replayReached(past_.at(shown->second), next - replay_->next);
  } catch (const Error& e) {
    return endReplay(e);  // the run itself has not failed
  }
  const SteadyClock::time_point end = SteadyClock::now();
  nextAnswer_ = end + kAnswersShare * (end - start);
  replay_->next = next;
  if (!wanted || !following) endReplay(std::nullopt);
}

void SimulationHost::endReplay(const std::optional<Error>& problem) {
  if (!std::exchange(replay_, std::nullopt)) return;
  listener_.replayEnded(problem);
}

void SimulationHost::tellFrame() {
  if (!frames_) frames_.emplace(*device_);
  listener_.frame(simulation_->frame(), frames_->make(*simulation_, view_));
}

void SimulationHost::tellNumbers() {
  const SteadyClock::time_point start = SteadyClock::now();
  listener_.numbers(runStatistics(*simulation_, RunEnd::kInterrupted));
  numbersPace_.made(start, SteadyClock::now());
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
  if (building_) {
    v["building"] = *building_;
  } else if (simulation_) {
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
    const bool presentIsKept = !simulation_->atFrame() || states_.has(simulation_->frame());
    v["whole"] = static_cast<std::int64_t>(states_.size()) + (presentIsKept ? 0 : 1);
  }
  if (problem_) v["problem"] = *problem_;
  return v;
}

}  // namespace weir::studio
