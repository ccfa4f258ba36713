// Completion of commands, options and files in a shell.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace weir::app {

/// A script for bash that completes the commands and options of `app`; also for zsh, after bashcompinit.
std::string bashCompletion(const CLI::App& app);

}  // namespace weir::app
