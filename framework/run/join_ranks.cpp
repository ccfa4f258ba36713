#include "framework/run/join_ranks.h"

#include <utility>

#include "framework/communication/on_ranks.h"
#include "framework/communication/shared_by_ranks.h"

namespace weir {

void joinRanks(Simulation& simulation, Communicator& ranks, bool watched) {
  for (const auto& node : simulation.scene().graph.nodes()) {
    auto* const onRanks = dynamic_cast<OnRanks*>(node.get());
    try {
      if (onRanks == nullptr)
        throw sceneError("a " + std::string(node->info().type) + " cannot run on several ranks yet", {},
                         "run without --ranks");
      onRanks->join(ranks);
    } catch (Error& e) {
      throw e.inNode(node->name()).at({.file = simulation.scene().file});
    }
  }
  const bool agreed = ranks.any(ranks.rank() == 0 && watched);
  for (const auto& node : simulation.scene().graph.nodes())
    if (auto* const shared = dynamic_cast<SharedByRanks*>(node.get())) shared->watch(agreed);
}

AgreedRun::AgreedRun(Communicator& ranks, const std::atomic<bool>& asked, RunOptions& options) {
  options.stop = &stop_;
  options.onProgress = [this, &ranks, &asked, told = std::move(options.onProgress)](const Simulation& run) {
    if (ranks.any(asked || savedToStop_)) stop_ = true;
    if (told) told(run);
  };
  options.agreeOnCheckpoint = [this, &ranks, saveAndStop = options.saveAndStop](bool isDue) {
    savedToStop_ = isDue && saveAndStop != nullptr && *saveAndStop;
    return ranks.any(isDue);
  };
}

}  // namespace weir
