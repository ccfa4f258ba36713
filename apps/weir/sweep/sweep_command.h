// weir sweep: runs a scene for each of many values of its parameters, and makes a table of the results.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/weir/program.h"
#include "apps/weir/sweep/points.h"
#include "apps/weir/sweep/sweep.h"

namespace weir::app {

class SweepCommand {
 public:
  SweepCommand(CLI::App& app, Program& program);

  /// Does what the command line says; an exit code, or throws an Error.
  int run();

  CLI::App& command() { return *command_; }

 private:
  PointList points() const;
  std::vector<std::size_t> chosenOf(const PointList& points) const;
  void checkOptions() const;
  SweepPlan plan(PointList points) const;
  void printTables() const;

  Program& program_;
  CLI::App* command_;
  std::string scene_, out_, sample_, task_;
  std::vector<std::string> set_, tables_, ranges_, options_;
  std::string device_ = "auto";
  std::uint64_t seed_ = 1;
  int jobs_ = 1, threads_ = 0;
  bool list_ = false, collect_ = false, quiet_ = false;
};

}  // namespace weir::app
