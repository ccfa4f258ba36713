#include "plugins/mpi/mpi_ranks.h"

#include <mpi.h>

#include <chrono>
#include <cstdlib>
#include <limits>
#include <list>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/communication/wait_limit.h"

namespace weir {

namespace {

enum Tag : int { kData = 1, kFailed = 2 };

class MpiRank final : public Communicator {
 public:
  MpiRank() {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm here = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
    MPI_Comm_size(here, &sizeHere_);
    MPI_Comm_free(&here);
  }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int sizeHere() const override { return sizeHere_; }

  void post(int to, Message message) override {
    forgetSent();
    if (message.size() > std::size_t(std::numeric_limits<int>::max()))
      throw simulationError("a message between ranks has more than 2 GiB", {}, "use more ranks");
    Sent& sent = sent_.emplace_back(std::move(message));
    MPI_Isend(sent.message.data(), static_cast<int>(sent.message.size()), MPI_BYTE, to, kData, MPI_COMM_WORLD,
              &sent.request);
  }

  Message receive(int from) override {
    const auto start = std::chrono::steady_clock::now();
    for (;;) {
      int arrived = 0, failed = 0;
      MPI_Message handle = MPI_MESSAGE_NULL;
      MPI_Status status;
      MPI_Improbe(from, kData, MPI_COMM_WORLD, &arrived, &handle, &status);
      if (arrived != 0) return take(handle, status);
      MPI_Iprobe(MPI_ANY_SOURCE, kFailed, MPI_COMM_WORLD, &failed, MPI_STATUS_IGNORE);
      if (failed != 0) throw RanksEnded();
      if (limit_ && std::chrono::steady_clock::now() - start > *limit_) throw waitedTooLong(from, *limit_);
      std::this_thread::yield();
    }
  }

  /// Of the environment variable; its Error ends all ranks, as they are there.
  void setLimit() { limit_ = rankWaitLimit(); }
  /// Tells all others that this rank goes no further.
  void tellOfFailure() {
    for (int to = 0; to < size_; ++to) {
      MPI_Request request = MPI_REQUEST_NULL;
      if (to != rank_) MPI_Isend(nullptr, 0, MPI_BYTE, to, kFailed, MPI_COMM_WORLD, &request);
      if (to != rank_) MPI_Request_free(&request);
    }
  }

  /// Until everything that was posted has been taken.
  void finish() {
    for (Sent& sent : sent_) MPI_Wait(&sent.request, MPI_STATUS_IGNORE);
    sent_.clear();
  }

 private:
  /// What must stay until it is on its way.
  struct Sent {
    explicit Sent(Message of) : message(std::move(of)) {}
    Message message;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  static Message take(MPI_Message& handle, const MPI_Status& status) {
    int bytes = 0;
    MPI_Get_count(&status, MPI_BYTE, &bytes);
    Message message(static_cast<std::size_t>(bytes));
    MPI_Mrecv(message.data(), bytes, MPI_BYTE, &handle, MPI_STATUS_IGNORE);
    return message;
  }

  void forgetSent() {
    sent_.remove_if([](Sent& sent) {
      int done = 0;
      MPI_Test(&sent.request, &done, MPI_STATUS_IGNORE);
      return done != 0;
    });
  }

  int rank_ = 0, size_ = 1, sizeHere_ = 1;
  std::optional<std::chrono::duration<double>> limit_;
  std::list<Sent> sent_;
};

/// Whether all ranks find the same by themselves: a wrong scene, or wrong arguments. Whoever is the first to
/// say so is then not told that another one has failed.
bool isOfAll(const std::exception_ptr& failed) {
  try {
    std::rethrow_exception(failed);
  } catch (const Error& e) {
    return e.kind() == ErrorKind::kScene || e.kind() == ErrorKind::kUsage;
  } catch (...) {
    return false;
  }
}

/// Waits until all ranks have come here, at most 10 s, and ends the launch.
[[noreturn]] void endTogether(int code) {
  constexpr std::chrono::seconds kMax{10};
  const auto start = std::chrono::steady_clock::now();
  MPI_Request all = MPI_REQUEST_NULL;
  MPI_Ibarrier(MPI_COMM_WORLD, &all);
  for (int done = 0; done == 0 && std::chrono::steady_clock::now() - start < kMax;) {
    MPI_Test(&all, &done, MPI_STATUS_IGNORE);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

}  // namespace

bool MpiRanks::present() const {
  return isOneOfALaunch();
}

std::vector<InfoEntry> MpiInfo::info() const {
  char version[MPI_MAX_LIBRARY_VERSION_STRING] = {};
  int length = 0;
  MPI_Get_library_version(version, &length);
  const std::string text(version, static_cast<std::size_t>(length));
  return {{"MPI", text.substr(0, text.find_first_of(",\n"))},
          {"mpirun or srun", MpiRanks().present() ? "has started this process, as one of several"
                                                  : "has not started this process"}};
}

void MpiRanks::run(const std::function<void(Communicator&)>& work,
                   const std::function<int(std::exception_ptr, int rank)>& failed) {
  int given = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given);
  MpiRank rank;
  try {
    rank.setLimit();
    work(rank);
    rank.finish();
  } catch (const RanksEnded&) {
    endTogether(kSimulationFailed);
  } catch (...) {
    if (!isOfAll(std::current_exception())) rank.tellOfFailure();
    endTogether(failed(std::current_exception(), rank.rank()));
  }
  MPI_Finalize();
}

}  // namespace weir
