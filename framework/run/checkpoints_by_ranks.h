// Checkpoints of a run on several ranks: each writes a part with the particles that it owns, beside the
// others, and rank 0 what there is once. Nothing is gathered. One rank alone has one file.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"
#include "framework/run/checkpoint.h"
#include "framework/run/checkpoint_parts.h"

namespace WEIR_API weir {

class CheckpointsByRanks {
 public:
  /// On every rank, of the same file, which all ranks see.
  CheckpointsByRanks(Checkpoints checkpoints, Communicator& ranks);

  /// As Checkpoints::begin().
  void begin(const Simulation& simulation);
  /// Of rank 0's, whose clock counts; false on others.
  bool isDue(const Simulation& simulation) const;
  /// On all ranks at the same frame. The file is replaced once all parts are on the disk; then parts go that
  /// neither it nor the one before names. Throws an io Error on the rank that cannot write; the checkpoints
  /// that there are stay then, and nothing else.
  void write(Simulation& simulation, std::span<Observer* const> observers);

 private:
  void writeParts(Checkpoint own, Checkpoint whole);
  /// What happens on all ranks or on none: where `work` fails on one, all make `undo`, and that one throws.
  void together(const std::function<void()>& work, const std::function<void()>& undo);
  /// Once the file names these. `keepsLast`: the last one is the one before.
  void finish(bool keepsLast, PartNames parts);

  Checkpoints checkpoints_;
  Communicator& ranks_;
  std::optional<PartNames> inUse_;  // by the file that is there, on rank 0; none: it cannot be read
};

}  // namespace weir
