// Runs scenes on the ranks of an MPI launch.
#pragma once

#include "framework/communication/launched_ranks.h"
#include "framework/run/info_source.h"

namespace weir {

class MpiRanks final : public LaunchedRanks {
 public:
  /// By what Open MPI, MPICH and Slurm tell their processes; asks MPI nothing, which would fail without a
  /// launcher.
  bool present() const override;
  void run(const std::function<void(Communicator&)>& work,
           const std::function<int(std::exception_ptr, int rank)>& failed) override;
};

/// Which MPI and which NCCL these are.
class MpiInfo final : public InfoSource {
 public:
  std::vector<InfoEntry> info() const override;
};

}  // namespace weir
