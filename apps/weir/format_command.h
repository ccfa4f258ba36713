// weir format: writes scene files in the layout of Weir.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/weir/program.h"

namespace weir::app {

class FormatCommand {
 public:
  FormatCommand(CLI::App& app, Program& program);

  /// Does what the command line says; an exit code, or throws an Error.
  int run();

  CLI::App& command() { return *command_; }

 private:
  int format(const std::string& file) const;

  Program& program_;
  CLI::App* command_;
  std::vector<std::string> files_;
  bool check_ = false;
  bool toStandardOutput_ = false;
};

}  // namespace weir::app
