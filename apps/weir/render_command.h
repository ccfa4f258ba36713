// weir render: makes videos and pictures of an export, without simulating again.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/weir/output_options.h"
#include "apps/weir/program.h"
#include "nodes/particle_file/recording.h"

namespace weir::app {

class RenderCommand {
 public:
  /// Adds the subcommand with its options, those of the outputs that plugins bring included.
  RenderCommand(CLI::App& app, Program& program);

  /// Does what the command line says; an exit code, or throws an Error.
  int run();

  CLI::App& command() { return *command_; }

 private:
  std::unique_ptr<Recording> openRecording() const;
  std::unique_ptr<Scene> loadScene(const Recording& recording);

  Program& program_;
  CLI::App* command_;
  std::unique_ptr<OutputOptions> outputs_;
  std::string file_, scene_, engine_;
  std::string device_ = "cpu";
  std::vector<std::string> set_;
  std::optional<std::int64_t> frame_;
  int threads_ = 0;
  bool quiet_ = false;
};

}  // namespace weir::app
