// The command line program: commands and options, and the one place where errors become messages.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "apps/weir/about_commands.h"
#include "apps/weir/bench/bench_command.h"
#include "apps/weir/command_line_errors.h"
#include "apps/weir/explain_command.h"
#include "apps/weir/format_command.h"
#include "apps/weir/new_plugin_command.h"
#include "apps/weir/program.h"
#include "apps/weir/render_command.h"
#include "apps/weir/run_command.h"
#include "apps/weir/scenes_command.h"
#include "apps/weir/standard_streams.h"
#include "apps/weir/studio_command.h"
#include "apps/weir/sweep/sweep_command.h"
#include "apps/weir/upgrade_command.h"
#include "apps/weir/validate_command.h"
#include "framework/base/build_info.h"
#include "framework/base/interruption.h"
#include "framework/base/text.h"

namespace weir::app {

namespace {

/// The values of --plugin, which must be loaded before the other options can be known.
std::vector<std::string> pluginArguments(int argc, char** argv) {
  constexpr std::string_view kOption = "--plugin";
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == kOption && i + 1 < argc)
      files.emplace_back(argv[++i]);
    else if (argument.starts_with(kOption) && argument.substr(kOption.size()).starts_with('='))
      files.emplace_back(argument.substr(kOption.size() + 1));
  }
  return files;
}

/// As it was typed, but for the folder of the program and where results go (--json).
std::string commandLine(int argc, char** argv) {
  constexpr std::string_view kOutput = "--json";
  std::string text = "weir";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == kOutput) ++i;
    if (!word.starts_with(kOutput)) text.append(" ").append(word);
  }
  return text;
}

/// `weir help` and `weir help COMMAND` as `weir --help` and `weir COMMAND --help`.
std::vector<std::string> argumentsOf(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.empty() || arguments.front() != "help") return arguments;
  arguments.erase(arguments.begin());
  if (arguments.size() > 1)
    throw usageError("'weir help' takes one command, and " + std::to_string(arguments.size()) + " are given",
                     "weir help [COMMAND]");
  arguments.push_back("--help");
  return arguments;
}

bool hasEnded = false;

/// For exit(). Libraries call it where they find no way on, as HDF5 does where an allocation fails, from any
/// thread and without a word.
void tellOfLibraryThatExits() {
  if (hasEnded) return;
  std::fputs("error: a library ended the program; the likely cause is that memory ran out\n", stderr);
  ::_exit(kSimulationFailed);
}

thread_local bool memoryRanOut = false;  // at least once, in this thread

/// For operator new.
void noteThatMemoryRanOut() {
  memoryRanOut = true;
  throw std::bad_alloc();
}

const std::terminate_handler kUsualEnd = std::get_terminate();

/// For std::terminate(). Nothing catches std::bad_alloc that static objects of a plugin's libraries throw,
/// and what functions of the C++ library throw that are noexcept and allocate.
[[noreturn]] void tellOfEndWithoutMemory() {
  if (!memoryRanOut) kUsualEnd();
  std::fputs("error: the program cannot go on; the likely cause is that memory ran out\n", stderr);
  ::_exit(kSimulationFailed);
}

int runProgram(Program& program, int argc, char** argv) {
  program.loadInstalledPlugins();
  for (const std::string& file : pluginArguments(argc, argv)) program.loadPlugin(file);
  std::atexit(tellOfLibraryThatExits);  // so it runs before what the plugins' libraries do at exit

  CLI::App app{"Simulates scenes of connected nodes, and makes videos of them.", "weir"};
  app.set_version_flag("--version", std::string(version()));
  app.require_subcommand(1);
  RunCommand run(app, program);
  SweepCommand sweep(app, program);
  RenderCommand render(app, program);
  BenchCommand bench(app, program);
  StudioCommand studio(app, program);
  ScenesCommand installed(app, program);
  ExplainCommand explain(app, program);
  FormatCommand format(app, program);
  UpgradeCommand upgrade(app, program);
  ValidateCommand validate(app, program);
  AboutCommands about(app, program);
  NewPluginCommand newPlugin(app, program);

  std::vector<std::string> arguments = argumentsOf(argc, argv);
  checkCommand(app, arguments);
  try {
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    app.parse(arguments);
  } catch (const CLI::Success& e) {
    return app.exit(e);  // --help and --version
  } catch (const CLI::ParseError& e) {
    throw commandLineError(app, e);
  }
  if (run.command().parsed()) return run.run();
  if (sweep.command().parsed()) return sweep.run();
  if (render.command().parsed()) return render.run();
  if (bench.command().parsed()) return bench.run(commandLine(argc, argv));
  if (studio.command().parsed()) return studio.run();
  if (installed.command().parsed()) return installed.run();
  if (explain.command().parsed()) return explain.run();
  if (format.command().parsed()) return format.run();
  if (upgrade.command().parsed()) return upgrade.run();
  if (validate.command().parsed()) return validate.run();
  if (newPlugin.command().parsed()) return newPlugin.run();
  return about.run();
}

/// runProgram() with its errors as messages and exit codes.
int runGuarded(int argc, char** argv) {
  Program program;
  try {
    const int code = runProgram(program, argc, argv);
    finishPrinting();
    return code;
  } catch (const Error& e) {
    program.log().error(e.what());
    return exitCode(e.kind());
  } catch (const Interrupted&) {
    program.log().info("interrupted before the first step");
    return kInterrupted;
  } catch (const std::bad_alloc&) {
    program.log().error("out of memory");
    return kSimulationFailed;
  } catch (const std::exception& e) {
    program.log().error(std::string("a mistake in the program, please report it: ") + e.what());
    return kSimulationFailed;
  }
}

}  // namespace

}  // namespace weir::app

int main(int argc, char** argv) {
  weir::app::openStandardStreams();
  std::set_new_handler(weir::app::noteThatMemoryRanOut);
  std::set_terminate(weir::app::tellOfEndWithoutMemory);
  int code = weir::kSimulationFailed;
  try {
    code = weir::app::runGuarded(argc, argv);
  } catch (const std::bad_alloc&) {
    // Not even enough for the program's log.
    std::fputs("error: out of memory\n", stderr);
  }
  weir::app::hasEnded = true;
  return code;
}
