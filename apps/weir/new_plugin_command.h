// weir new-plugin: writes a small project of a plugin, from the template that comes with the program.
#pragma once

#include <string>

#include "apps/weir/program.h"

namespace weir::app {

/// Copies the template share/weir/templates/plugin to `folder`, or to ./NAME if that is empty, with the
/// plugin's name in place of "my_plugin" and "MyPlugin", and prints what to do next. Throws a usage Error for
/// a name that no plugin may have, an io Error if the folder exists or cannot be written. An exit code.
int newPlugin(Program& program, const std::string& name, const std::string& folder);

}  // namespace weir::app
