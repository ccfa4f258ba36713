// weir new-plugin: writes a small project of a plugin, from the template that comes with the program.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "apps/weir/program.h"

namespace weir::app {

class NewPluginCommand {
 public:
  NewPluginCommand(CLI::App& app, Program& program);

  /// Copies the template share/weir/templates/plugin to the folder, or to ./NAME, with the plugin's name in
  /// place of "my_plugin" and "MyPlugin", and prints what to do next. Throws a usage Error for a name that no
  /// plugin may have, an io Error if the folder exists or cannot be written. An exit code.
  int run();

  CLI::App& command() { return *command_; }

 private:
  Program& program_;
  CLI::App* command_;
  std::string name_, folder_;
};

}  // namespace weir::app
