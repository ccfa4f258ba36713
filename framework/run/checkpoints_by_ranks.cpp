#include "framework/run/checkpoints_by_ranks.h"

#include <exception>
#include <system_error>
#include <utility>
#include <vector>

#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "framework/particles/divided_particles.h"
#include "framework/particles/owned_particles.h"
#include "framework/run/saved_outputs.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

/// The rows of this rank, where Simulation::save() has those of all in a run without ranks.
StateArrays ownRows(const Simulation& simulation) {
  StateArrays rows;
  const StateWriter nodes = StateWriter(rows).in("nodes");
  for (const auto& node : simulation.scene().graph.nodes())
    if (auto* const shared = dynamic_cast<OwnedParticles*>(node.get())) {
      shared->owned().refreshCount();
      saveRows(shared->owned(), nodes.in(node->name()).in(kSavedParticles));
    }
  return rows;
}

/// Returns whether it was not there.
bool makeFolder(const fs::path& folder) {
  std::error_code error;
  const bool made = fs::create_directory(folder, error);
  if (error) throw ioError("cannot make the folder: " + error.message()).at({.file = folder.string()});
  if (made) syncFolderOf(folder);
  return made;
}

}  // namespace

CheckpointsByRanks::CheckpointsByRanks(Checkpoints checkpoints, Communicator& ranks)
    : checkpoints_(std::move(checkpoints)), ranks_(ranks) {}

void CheckpointsByRanks::begin(const Simulation& simulation) {
  if (ranks_.rank() > 0) return;
  checkpoints_.begin(simulation);
  inUse_ = partsInUse(checkpoints_.store(), checkpoints_.file());
  if (ranks_.size() == 1) return;
  // Before the run, as its result may be lost where it cannot be made.
  const fs::path folder = folderOfParts(checkpoints_.file());
  std::error_code ignored;
  if (makeFolder(folder)) fs::remove(folder, ignored);
}

bool CheckpointsByRanks::isDue(const Simulation& simulation) const {
  return ranks_.rank() == 0 && checkpoints_.isDue(simulation);
}

void CheckpointsByRanks::write(Simulation& simulation, std::span<Observer* const> observers) {
  Checkpoint whole = checkpoints_.about(simulation);
  // First, as they wait until all is on the disk.
  saveOutputs(observers, StateWriter(whole.state).in(kOutputStates));
  if (ranks_.rank() == 0) simulation.save(StateWriter(whole.state));
  Checkpoint part = checkpoints_.about(simulation);
  part.state = ownRows(simulation);
  if (ranks_.size() == 1) {
    whole.state.merge(part.state);
    finish(checkpoints_.put(whole), {});
  } else {
    writeParts(std::move(part), std::move(whole));
  }
}

void CheckpointsByRanks::writeParts(Checkpoint own, Checkpoint whole) {
  const fs::path& file = checkpoints_.file();
  if (ranks_.rank() == 0) makeFolder(folderOfParts(file));
  const std::int64_t number = ranks_.max(ranks_.rank() == 0 ? nextNumberOfParts(file) : 0);
  const fs::path ownFile = file.parent_path() / nameOfPart(file, number, ranks_.rank());
  const auto removeOwn = [&] {
    std::error_code ignored;
    fs::remove(ownFile, ignored);
  };
  saveRankOfPart(own.state, ranks_.rank());
  together(
      [&] {
        checkpoints_.store().write(ownFile, own);
        syncFolderOf(ownFile);
      },
      removeOwn);
  CheckpointParts parts{.names = {}, .digests = ranks_.allGather(digestOf(own.state))};
  own = {};
  for (int rank = 0; rank < ranks_.size(); ++rank) parts.names.push_back(nameOfPart(file, number, rank));
  parts.save(whole.state);
  bool keepsLast = false;
  const auto put = [&] {
    if (ranks_.rank() == 0) keepsLast = checkpoints_.put(whole);
  };
  together(put, [&] {
    removeOwn();
    if (ranks_.rank() == 0) removeUnnamedParts(checkpoints_.store(), file);
  });
  if (ranks_.rank() == 0) finish(keepsLast, PartNames(parts.names.begin(), parts.names.end()));
}

void CheckpointsByRanks::finish(bool keepsLast, PartNames parts) {
  const std::optional<PartNames> before = std::exchange(inUse_, parts);
  if (keepsLast && before) {
    parts.insert(before->begin(), before->end());
    removeOtherParts(checkpoints_.file(), parts);
  } else {
    removeUnnamedParts(checkpoints_.store(), checkpoints_.file());
  }
  syncFolderOf(checkpoints_.file());
}

void CheckpointsByRanks::together(const std::function<void()>& work, const std::function<void()>& undo) {
  std::exception_ptr failure;
  try {
    work();
  } catch (...) {
    failure = std::current_exception();
  }
  if (!ranks_.any(failure != nullptr)) return;
  undo();
  ranks_.sum(0);  // so that nothing is left when one ends all
  if (failure) std::rethrow_exception(failure);
  ranks_.sum(0);  // which ends by the error of another
}

}  // namespace weir
