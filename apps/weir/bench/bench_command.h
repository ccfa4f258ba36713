// weir bench: times steps of the scenes that come with the program, and compares them with the memory's
// speed.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/weir/bench/report.h"
#include "apps/weir/program.h"

namespace weir::app {

class BenchCommand {
 public:
  BenchCommand(CLI::App& app, Program& program);

  /// Runs what the command line says; an exit code, or throws an Error. `commandLine` is kept with the
  /// results.
  int run(const std::string& commandLine);

  CLI::App& command() { return *command_; }

 private:
  /// One simulation that is to be timed. Scenes are built before the first is run, so that mistakes show at
  /// once.
  struct Job {
    BenchCase benchCase;
    std::optional<BlockSize> size;
    double lateAfter = 0;          // s
    std::vector<std::string> set;  // all changes to the scene
    std::unique_ptr<Scene> scene;
  };

  std::vector<BenchCase> chosenCases() const;
  std::vector<BlockSize> chosenSizes(bool onCpu) const;
  Job makeJob(const BenchCase& benchCase, const std::optional<BlockSize>& size);
  std::vector<Job> makeJobs(bool onCpu);
  BenchResult runJob(Job& job, const std::atomic<bool>& stop);
  Value asValue(const std::vector<BenchResult>& results, std::string_view end) const;
  /// Writes the JSON, if it was asked for. After each job, so that a run that is killed leaves what it had.
  void save(const std::vector<BenchResult>& results, std::string_view end) const;

  Program& program_;
  CLI::App* command_;

  std::string device_ = "auto";
  std::vector<std::string> cases_;
  std::vector<std::int64_t> sizes_;
  std::vector<std::string> set_;
  std::string json_;
  std::optional<double> lateAfter_;
  int threads_ = 0;
  bool deterministic_ = false;
  bool quick_ = false;

  std::string commandLine_;
  Value machine_;
  double bandwidth_ = 0;  // bytes/s
};

}  // namespace weir::app
