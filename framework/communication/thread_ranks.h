// Ranks as threads of one process.
#pragma once

#include <functional>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"

namespace WEIR_API weir {

/// Calls work(communicator) once for each of so many ranks, each on a thread of its own but rank 0, which has
/// the caller's. Where one throws, the others end as soon as they wait for a rank; then the first error is
/// thrown again. An Error that is not of the scene or the command line, which all ranks share, gains the
/// number of its rank.
void runOnThreads(int ranks, const std::function<void(Communicator&)>& work);

}  // namespace weir
