// weir run: simulates a scene and writes what is asked for.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/weir/output_options.h"
#include "apps/weir/program.h"
#include "framework/base/interruption.h"
#include "framework/communication/launched_ranks.h"
#include "framework/run/checkpoint.h"

namespace weir::app {

class RunCommand {
 public:
  /// Adds the subcommand with its options, those of the outputs that plugins bring included.
  RunCommand(CLI::App& app, Program& program);

  /// Runs what the command line says; an exit code, or throws an Error.
  int run();

  CLI::App& command() { return *command_; }

 private:
  std::vector<Override> overrides() const;
  /// Those of this rank, or of a run that has none; `ranks` is null there.
  std::vector<std::unique_ptr<Observer>> makeObservers(const Scene& scene, Communicator* ranks) const;
  /// Throws where one cannot be, and where another run has it.
  std::vector<OutputLock> takeOutputPaths() const;
  /// What names of checkpoints may end in; asked for only if one is to be made.
  std::vector<std::string> checkpointEndings() const;
  std::unique_ptr<CheckpointStore> checkpointStore(const std::string& option, const std::string& path) const;
  Checkpoints makeCheckpoints() const;
  /// What --resume names, if it belongs to the simulation; with `auto`, the newest one if there is any.
  std::optional<Checkpoint> readCheckpoint(const Simulation& simulation, Communicator* ranks) const;
  void printResults() const;
  OnWarning onWarning() const;
  /// The run of one rank, or of a run that has none; `ranks` is null there.
  RunEnd runScene(std::unique_ptr<Scene> scene, Device& device, Log& log, Communicator* ranks) const;
  RunEnd runOnRanks() const;
  /// Of a rank of those on this machine. GPUs are dealt out in turn.
  std::unique_ptr<Device> openDeviceOf(int rankHere, int ranksHere) const;
  /// As --gpus says, by way of the options that it stands for.
  void divideAmongGpus();
  /// This process as one of those that a launcher has started.
  int runLaunched(LaunchedRanks& launched) const;
  /// As rank 0 does, which says what is doubtful in it.
  std::unique_ptr<Scene> loadSilently() const;

  Program& program_;
  CLI::App* command_;
  std::unique_ptr<OutputOptions> outputs_;

  std::string scene_, engine_;
  std::string device_ = "auto";
  std::string duration_;
  std::optional<std::int64_t> frames_;
  std::vector<std::string> set_;
  std::string checkpoint_;
  std::string checkpointEvery_ = "600s";
  std::string resume_;
  std::string stats_;
  std::string series_;
  int threads_ = 0;
  std::optional<int> ranks_, gpus_;
  bool deterministic_ = false;
  bool profileKernels_ = false;
  bool quiet_ = false;
};

}  // namespace weir::app
