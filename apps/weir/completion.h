// Completion of commands, options and files in a shell.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace weir::app {

/// A script for bash that completes the commands and options of `app`, the names of scenes that come with
/// Weir, and files; also for zsh, after bashcompinit.
std::string bashCompletion(const CLI::App& app, const std::vector<std::string>& scenes);

}  // namespace weir::app
