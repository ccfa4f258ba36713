// weir scenes: the scenes that come with Weir, to run or to begin with.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "apps/weir/program.h"

namespace weir::app {

class ScenesCommand {
 public:
  ScenesCommand(CLI::App& app, Program& program);

  /// Does what the command line says; an exit code, or throws an Error.
  int run();

  CLI::App& command() { return *command_; }

 private:
  std::string listed();
  std::string told(const std::string& name);
  /// "up to 37,026 particles", or what keeps it from being known.
  std::string particlesOf(const std::string& name);
  void copy() const;

  Program& program_;
  CLI::App* command_;
  std::string name_;
  std::string copy_;
};

}  // namespace weir::app
