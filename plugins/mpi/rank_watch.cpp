#include "plugins/mpi/rank_watch.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "framework/base/text.h"

namespace weir {

namespace {

using Milliseconds = std::chrono::milliseconds;
constexpr Milliseconds kBetweenBeats{1000}, kMaxSilence{10000};

enum Beat : char { kHere, kEnded };

/// Of a process.
struct Place {
  char host[256] = {};  // POSIX allows 255
  int process = 0;
};

Place thisPlace() {
  Place place{.process = ::getpid()};
  static_cast<void>(::gethostname(place.host, sizeof(place.host) - 1));
  return place;
}

/// Whether a debugger holds a process of this machine.
bool isTraced(int process) {
  const std::string key = "TracerPid:";
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string word; status >> word;)
    if (int tracer = 0; word == key && status >> tracer) return tracer != 0;
  return false;
}

}  // namespace

struct RankWatch::Impl {
  explicit Impl(Silent of) : silent(std::move(of)) {
    MPI_Comm_dup(MPI_COMM_WORLD, &beats);
    MPI_Comm_rank(beats, &rank);
    MPI_Comm_size(beats, &size);
    own = thisPlace();
    std::vector<Place> all(static_cast<std::size_t>(size));
    MPI_Allgather(&own, sizeof(Place), MPI_BYTE, all.data(), sizeof(Place), MPI_BYTE, beats);
    watched = all[static_cast<std::size_t>(before())];
    thread = std::jthread([this] { watch(); });
  }

  int before() const { return (rank + size - 1) % size; }

  void watch() {
    // Time that this process was stopped for itself does not count.
    Milliseconds silence{0}, sinceBeat = kBetweenBeats;
    bool hasToldEnd = false, hasOtherEnded = false;
    while (!hasToldEnd || !hasOtherEnded) {
      const bool ends = isEnding();
      if (sinceBeat >= kBetweenBeats || ends) {
        if (!hasToldEnd) tell(ends ? kEnded : kHere);
        hasToldEnd = ends;
        sinceBeat = Milliseconds{0};
      }
      for (std::optional<Beat> beat; (beat = nextBeat());) {
        hasOtherEnded = beat == kEnded;
        silence = Milliseconds{0};
      }
      if (hasOtherEnded || (silence >= kMaxSilence && isHeld())) silence = Milliseconds{0};
      if (silence >= kMaxSilence) return silent(words());
      const Milliseconds waited = wait(ends);
      silence += waited, sinceBeat += waited;
    }
  }

  void tell(Beat beat) const {
    const char byte = beat;
    MPI_Send(&byte, 1, MPI_BYTE, (rank + 1) % size, 0, beats);
  }
  std::optional<Beat> nextBeat() const {
    int arrived = 0;
    MPI_Iprobe(before(), 0, beats, &arrived, MPI_STATUS_IGNORE);
    if (arrived == 0) return std::nullopt;
    char byte = 0;
    MPI_Recv(&byte, 1, MPI_BYTE, before(), 0, beats, MPI_STATUS_IGNORE);
    return static_cast<Beat>(byte);
  }

  /// Whether whoever debugs the other rank keeps it from answering.
  bool isHeld() const { return std::string(watched.host) == own.host && isTraced(watched.process); }
  std::string words() const {
    return "rank " + std::to_string(before()) + " (process " + std::to_string(watched.process) + " on " +
           printable(watched.host) + ") has not answered for " +
           std::to_string(std::chrono::duration_cast<std::chrono::seconds>(kMaxSilence).count()) +
           " s: it was stopped, or its machine does not respond";
  }

  bool isEnding() {
    const std::lock_guard lock(mutex);
    return ending;
  }
  /// A moment; less of it once all are about to end.
  Milliseconds wait(bool briefly) {
    const Milliseconds moment{briefly ? 5 : 200};
    std::unique_lock lock(mutex);
    changed.wait_for(lock, moment, [&] { return ending && !briefly; });
    return moment;
  }
  void end() {
    const std::lock_guard lock(mutex);
    ending = true;
    changed.notify_one();
  }

  Silent silent;
  MPI_Comm beats = MPI_COMM_NULL;
  int rank = 0, size = 1;
  Place own, watched;
  std::mutex mutex;  // of what follows
  std::condition_variable changed;
  bool ending = false;
  std::jthread thread;
};

RankWatch::RankWatch(Silent silent) : impl_(std::make_unique<Impl>(std::move(silent))) {}

RankWatch::~RankWatch() {
  impl_->end();
  impl_->thread.join();
  MPI_Comm_free(&impl_->beats);
}

}  // namespace weir
