#include "framework/run/join_ranks.h"

#include <functional>
#include <utility>

#include "framework/communication/on_ranks.h"

namespace weir {

namespace {

void forEachShared(Simulation& simulation, const std::function<void(SharedByRanks&)>& work) {
  for (const auto& node : simulation.scene().graph.nodes())
    if (auto* const shared = dynamic_cast<SharedByRanks*>(node.get())) work(*shared);
}

}  // namespace

void joinRanks(Simulation& simulation, Communicator& ranks, WatchedByRanks watched) {
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
  const bool speaks = ranks.rank() == 0;
  const WatchedByRanks agreed{.frames = ranks.any(speaks && watched.frames),
                              .checkpoints = ranks.any(speaks && watched.checkpoints)};
  forEachShared(simulation, [&](SharedByRanks& shared) { shared.watch(agreed); });
}

AgreedRun::AgreedRun(Communicator& ranks, const std::atomic<bool>& asked, RunOptions& options) {
  options.stop = &stop_;
  options.onProgress = [this, &ranks, &asked, told = std::move(options.onProgress)](const Simulation& run) {
    if (ranks.any(asked || savedToStop_)) stop_ = true;
    if (told) told(run);
  };
  options.atFrame = [this, &ranks, saveAndStop = options.saveAndStop](Simulation& run, bool makesCheckpoint) {
    savedToStop_ = makesCheckpoint && saveAndStop != nullptr && *saveAndStop;
    const bool anyMakes = ranks.any(makesCheckpoint);
    if (anyMakes) forEachShared(run, [](SharedByRanks& shared) { shared.gather(); });
    return anyMakes;
  };
}

}  // namespace weir
