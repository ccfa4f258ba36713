// weir upgrade: brings old names in scene files to those of today.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/weir/program.h"

namespace weir::app {

class UpgradeCommand {
 public:
  UpgradeCommand(CLI::App& app, Program& program);

  /// Does what the command line says; an exit code, or throws an Error.
  int run();

  CLI::App& command() { return *command_; }

 private:
  int upgrade(const std::string& file);

  Program& program_;
  CLI::App* command_;
  std::vector<std::string> files_;
  bool check_ = false;
};

}  // namespace weir::app
