// weir studio: serves the page on which scenes are composed, tuned and watched.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/weir/program.h"

namespace weir::app {

class StudioCommand {
 public:
  /// Adds the subcommand with its options.
  StudioCommand(CLI::App& app, Program& program);

  /// Serves until it is interrupted; an exit code, or throws an Error.
  int run();

  CLI::App& command() { return *command_; }

 private:
  [[maybe_unused]] Program& program_;  // used where the studio is built
  CLI::App* command_;
  std::string scene_;
  std::string folder_;
  std::vector<std::string> sceneFolders_;
  std::string host_ = "127.0.0.1";
  std::string device_ = "auto";
  int port_ = 0;
  int threads_ = 0;
  int framesMb_ = 1024;
  bool stay_ = false;
  bool newToken_ = false;
};

}  // namespace weir::app
