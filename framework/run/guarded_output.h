// Outputs of plugins: whatever their observers throw becomes an Error that names output, hook and plugin.
#pragma once

#include <memory>
#include <string>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"
#include "framework/run/output_kind.h"

namespace WEIR_API weir {

/// The options of an output kind of the library `source`; see Registry::setSource.
std::vector<OutputOption> optionsOf(const OutputKind& kind, const std::string& name,
                                    const std::string& source);

/// Whether it takes part in `weir render`.
bool showsReplays(const OutputKind& kind, const std::string& name, const std::string& source);

/// Whether every rank of a run of this scene has an observer of the kind; see OutputByRanks.
bool isByRanks(const OutputKind& kind, const std::string& name, const std::string& source,
               const Scene& scene);

/// Its observer for these paths, each of whose functions is guarded. An Error that names a file passes as it
/// is: it says enough. `ranks` are given where isByRanks().
std::unique_ptr<Observer> makeGuardedObserver(const OutputKind& kind, const std::string& name,
                                              const std::string& source, const OutputPaths& paths,
                                              Communicator* ranks = nullptr);

}  // namespace weir
