// Ranks that a launcher, such as mpirun or srun, has started as processes of their own. Plugins bring them.
#pragma once

#include <exception>
#include <functional>
#include <string_view>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"

namespace WEIR_API weir {

/// Whether such a launcher has started this process as one of several, as its environment tells. Whoever runs
/// a scene without a LaunchedRanks then does the same as all others.
bool isOneOfALaunch();

class LaunchedRanks {
 public:
  static constexpr std::string_view kInterface = "LaunchedRanks";
  virtual ~LaunchedRanks() = default;

  /// Whether this process is one of several of such a launch.
  virtual bool present() const = 0;
  /// Calls work(communicator), once a process. Where it throws, the other ranks end as soon as they wait for
  /// one; when all have ended, or after 10 s, the launch ends with the code that failed(error, rank) gives,
  /// which is called on ranks with an error of their own only, and this does not return.
  virtual void run(const std::function<void(Communicator&)>& work,
                   const std::function<int(std::exception_ptr, int rank)>& failed) = 0;
};

}  // namespace weir
