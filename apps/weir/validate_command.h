// weir validate: checks scenes without running them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/weir/program.h"

namespace weir::app {

class ValidateCommand {
 public:
  ValidateCommand(CLI::App& app, Program& program);

  /// Checks each scene and the files that it names, and prints "SCENE: valid" or the error. Returns the exit
  /// code of the first that is not valid, or 0.
  int run();

  CLI::App& command() { return *command_; }

 private:
  Program& program_;
  CLI::App* command_;
  std::vector<std::string> scenes_, set_;
};

}  // namespace weir::app
