// weir nodes, schema, info and completion: what this program can do, and what files hold.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/weir/program.h"

namespace weir::app {

class AboutCommands {
 public:
  AboutCommands(CLI::App& app, Program& program);

  /// Does what the command line says, if it says one of these; an exit code, or throws an Error.
  int run();

 private:
  void addNodes();
  void addInfo();
  int tellOfTypes() const;
  int tellOfProgramOrFiles() const;

  CLI::App& app_;
  Program& program_;
  CLI::App *nodes_ = nullptr, *schema_ = nullptr, *info_ = nullptr, *completion_ = nullptr;
  std::string type_;
  bool json_ = false;
  std::vector<std::string> files_;
  bool sceneOnly_ = false;
};

}  // namespace weir::app
