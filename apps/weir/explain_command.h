// weir explain: tells in sentences what a scene will do.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/weir/program.h"
#include "framework/run/simulation.h"

namespace weir::app {

class ExplainCommand {
 public:
  ExplainCommand(CLI::App& app, Program& program);

  /// Does what the command line says; an exit code, or throws an Error.
  int run();

  CLI::App& command() { return *command_; }

 private:
  std::unique_ptr<Scene> loadedScene();
  void tellAmounts(Simulation& simulation);
  void tellWarnings() const;

  Program& program_;
  CLI::App* command_;
  std::string scene_;
  std::vector<std::string> set_;
  std::string device_ = "auto";
  int threads_ = 0;
  bool measure_ = false;
  std::vector<std::string> warnings_;
};

}  // namespace weir::app
