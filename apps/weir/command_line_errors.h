// What is wrong with a command line, in the words of all errors: CLI11's own name no option that was meant,
// and no bound that a reader knows.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "framework/base/error.h"

namespace weir::app {

/// Throws a usage Error if the first argument is no command and no option.
void checkCommand(const CLI::App& app, const std::vector<std::string>& arguments);

/// The usage Error for what `app` threw when it parsed the arguments.
Error commandLineError(const CLI::App& app, const CLI::ParseError& thrown);

/// For options that take a number of at least 0.
CLI::Validator notNegative();

}  // namespace weir::app
