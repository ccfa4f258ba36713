#include "plugins/mpi/mpi_ranks.h"

#include <mpi.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include "framework/base/error.h"
#include "plugins/mpi/mpi_rank.h"
#include "plugins/mpi/nccl_library.h"
#include "plugins/mpi/rank_watch.h"

namespace weir {

namespace {

/// Its version, or why GPUs of ranks go without it.
std::string ncclInfo() {
  try {
    return NcclLibrary::open()->version() + ", between GPUs of ranks";
  } catch (const Error& e) {
    return e.message() + "; GPUs of ranks exchange by way of the hosts";
  }
}

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

[[noreturn]] void endAll(int code) {
  MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
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
  endAll(code);
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
                                                  : "has not started this process"},
          {"NCCL", builtWithCuda() ? ncclInfo() : "not used, as this build has no CUDA"}};
}

void MpiRanks::run(const std::function<void(Communicator&)>& work,
                   const std::function<int(std::exception_ptr, int rank)>& failed) {
  int given = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_MULTIPLE, &given);
  MpiRank rank;
  std::optional<RankWatch> watch;
  if (given == MPI_THREAD_MULTIPLE)
    watch.emplace([&](const std::string& what) {
      endAll(failed(std::make_exception_ptr(simulationError(what)), rank.rank()));
    });
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
  watch.reset();
  MPI_Finalize();
}

}  // namespace weir
