#include "plugins/vtkhdf/isolated.h"

#include <algorithm>
#include <optional>

#include "framework/base/isolated_work.h"
#include "plugins/vtkhdf/files_elsewhere.h"
#include "plugins/vtkhdf/hdf5.h"

namespace weir::hdf5 {

std::string runIsolated(const std::function<std::string()>& work, int cpuSeconds) {
  std::optional<IsolatedWork> copy;
  {
    const Session session;  // so that no other thread is within HDF5 while the copy is made
    const auto inCopy = [&] {
      Session::renewLock();
      return work();
    };
    copy.emplace(inCopy, ForkedLimits{.cpuSeconds = cpuSeconds}, "the HDF5 library");
  }
  return copy->finish();
}

int cpuSecondsFor(const std::filesystem::path& file) {
  constexpr double kMin = 20, kMax = 1e6, kBytesPerSecond = 1e6;
  return static_cast<int>(std::min(kMin + bytesOfSet(file) / kBytesPerSecond, kMax));
}

}  // namespace weir::hdf5
