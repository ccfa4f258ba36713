// Runs the studio's simulation on a thread of its own. Callers ask; what comes of it is told to a listener.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "apps/studio/session/body_pull.h"
#include "apps/studio/session/busy_share.h"
#include "apps/studio/session/number_pace.h"
#include "apps/studio/session/past_run.h"
#include "apps/studio/session/question_queue.h"
#include "apps/studio/session/recording.h"
#include "apps/studio/session/run_orders.h"
#include "framework/base/error.h"
#include "framework/run/simulation.h"

namespace weir::studio {

enum class HostState { kEmpty, kBuilding, kPaused, kPlaying, kFinished, kFailed };

/// "empty", "building", "paused", "playing", "finished" or "failed".
std::string_view nameOf(HostState state);

/// What is told, on the simulation's thread.
class HostListener {
 public:
  virtual ~HostListener() = default;
  /// {state, device, frame, frames, time, duration, steps, particles, stepping_seconds, device_busy,
  /// building, whole, problem}; the numbers only where there is a simulation, building {node, done, all} only
  /// while its nodes are set up, the problem (see problemOf) only where it failed. device_busy is the share
  /// of the last second that steps took, 0 where it does not play; whole is how many of the run's frames
  /// replay() would find.
  virtual void status(const Value& status) = 0;
  /// Of the run so far, at a frame, see runStatistics; a few times a second, but more rarely where they would
  /// take more than a hundredth of the time.
  virtual void numbers(const Value& numbers) = 0;
  virtual void frame(std::int64_t frame, const Packet& packet) = 0;
  virtual void geometry(const Packet& packet) = 0;
  /// The simulation has reached a frame. It waits meanwhile.
  virtual void reached(Simulation& simulation) = 0;
  /// The run goes on from one of its frames: what it came to after that is not of it any more.
  virtual void wentBack(std::int64_t frame) = 0;
  /// What serve() has asked for; null if there is no simulation.
  virtual void serve(Simulation* simulation) = 0;
  /// It will be gone when this returns.
  virtual void leaving() = 0;
  /// What runAt() has given back will be at another frame when this returns.
  virtual void pastChanging() = 0;
  /// The same, and it will be gone.
  virtual void pastLeaving() = 0;
  /// What replay() has asked for: the run as it was at a frame that is kept whole. It stands for `frames` of
  /// the run, up to the next that is. False: no more are wanted.
  virtual bool replayReached(Simulation& then, std::int64_t frames) = 0;
  /// That was the last one, or there are none for this reason, such as too little memory.
  virtual void replayEnded(const std::optional<Error>& problem) = 0;
};

class SimulationHost {
 public:
  /// `threads` as for openDevice. Log, registry and listener must outlive it. `maxStateBytes` is what the
  /// states of frames may take that a run can go on from.
  SimulationHost(const Registry& registry, Log& log, HostListener& listener, int threads,
                 std::int64_t maxStateBytes);
  /// Ends the simulation within a step.
  ~SimulationHost();
  SimulationHost(const SimulationHost&) = delete;
  SimulationHost& operator=(const SimulationHost&) = delete;

  // From any thread; each returns at once.

  /// Takes another scene and brings it to time 0 on a device, "auto", "cpu", "cuda:0". What was before is
  /// gone, and a scene that was still waiting for its turn or being built is passed over. Null for no scene.
  /// `again` is the same scene once more, for runAt.
  void load(std::unique_ptr<Scene> scene, std::unique_ptr<Scene> again, std::string device);
  /// The same from a frame of the run that is there, or the last one before it that is kept, in place of time
  /// 0. The scene differs from that run's in no more than what may change during a run.
  void goOn(std::unique_ptr<Scene> scene, std::unique_ptr<Scene> again, std::string device,
            std::int64_t frame);
  void play();
  void pause();
  void advance(std::int64_t frames);  ///< that many more than were asked for, and then pauses
  void change(std::vector<LiveChange> changes);
  void pull(BodyWish wish);  ///< see BodyPull; of the scene that was given last, which has this body
  void release();
  void show(FrameView view);
  /// Has the listener's serve() called before the next step.
  void serve();
  /// Goes through the frames of the run so far, in order, as far as they are kept whole: the listener's
  /// replayReached() gets one between two steps, and while it plays in a small share of the time, as those
  /// who ask. Another scene ends it.
  void replay();
  /// Calls f with the simulation between two steps, or with null if there is none. While it plays, clients
  /// take turns, one between two steps, and a small share of the time. False if too many questions of the
  /// client wait, see QuestionQueue.
  [[nodiscard]] bool ask(std::uint64_t client, QuestionQueue::Question f);
  /// The client is gone: nobody wants to know what it has asked.
  void forget(std::uint64_t client);

  // On its own thread, in the answer to a question and while there is a simulation.

  /// The run as it was at a frame, or at the nearest one whose state is kept; the run itself where it stands
  /// there. Throws a usage Error if there is none, with the reason.
  Simulation& runAt(std::int64_t frame);

 private:
  /// Adds to the orders, and wakes the thread.
  void order(const std::function<void(RunOrders&)>& add);
  void work();
  /// What was ordered; waits for something to do where there is nothing else.
  RunOrders takeOrders();
  void obey(RunOrders orders);
  void answerOne();
  /// Whether a question may be answered now: while it plays they get a small share of the time.
  bool mayAnswer() const;
  /// Runs f; what it throws ends the simulation's run, and is told.
  void guarded(const std::function<void()>& f);
  void takeScene(RunOrders::Load load);
  /// From a state, or to time 0 where that is null.
  void build(std::unique_ptr<Scene> scene, const RunState& from);
  void keepState();
  RunState presentState() const;
  void beginReplay();
  void advanceReplay();
  void endReplay(const std::optional<Error>& problem);
  /// The first frame from this one on that is kept whole, with its state; nothing if the replay has no more.
  std::optional<std::pair<std::int64_t, RunState>> nextOfReplay(std::int64_t from) const;
  void advanceBy(std::int64_t frames);
  void advanceNow();
  void frameReached();
  void tellFrame();
  void tellNumbers();
  void go(std::optional<std::int64_t> pauseAt);
  void tell(HostState state);
  Value status();

  const Registry& registry_;
  Log& log_;
  HostListener& listener_;
  const int threads_;

  std::mutex mutex_;
  std::condition_variable wake_;
  RunOrders orders_;
  QuestionQueue questions_;
  std::atomic<bool> ordered_ = false;   // an order waits, or it is to end
  std::atomic<bool> asked_ = false;     // a question waits
  std::atomic<bool> replaced_ = false;  // another scene waits, so nobody wants the one that is being built

  // The rest belongs to the thread.
  std::unique_ptr<Device> device_;
  std::unique_ptr<Simulation> simulation_;
  std::optional<FrameMaker> frames_;  // with the simulation
  std::string deviceName_, deviceDescription_;
  HostState state_ = HostState::kEmpty;
  std::optional<Value> problem_;
  std::optional<Value> building_;
  std::optional<std::int64_t> pauseAt_;  // a frame
  const std::int64_t maxStateBytes_;
  KeptStates states_;
  PastRun past_;
  struct Replay {
    std::int64_t next = 0;  // frames before it were shown
    std::int64_t last = 0;
    RunState present;  // of the last frame, where it is not one of states_
  };
  std::optional<Replay> replay_;
  BodyPull pull_;
  FrameView view_;
  BusyShare busy_;
  std::chrono::steady_clock::time_point told_{};  // when the status was told last
  NumberPace numbersPace_;
  std::chrono::steady_clock::time_point kept_{};        // when a state was kept last
  std::chrono::steady_clock::duration keeping_{};       // how long that took
  std::chrono::steady_clock::time_point nextAnswer_{};  // no question is answered before, while it plays

  std::atomic<bool> quit_ = false;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace weir::studio
