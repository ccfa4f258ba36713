#include "apps/weir/output_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "apps/weir/standard_streams.h"
#include "framework/base/text.h"
#include "framework/run/guarded_output.h"
#include "framework/run/output_paths.h"

namespace weir::app {

namespace fs = std::filesystem;

void addEngineOption(CLI::App& command, std::string& engine) {
  command
      .add_option(
          "--engine", engine,
          "What draws pictures: weir, or cycles, the path tracer of Blender; the scene's render.engine "
          "if it is left out")
      ->type_name("weir|cycles")
      ->check(CLI::IsMember({"weir", "cycles"}));
}

void addEngine(const std::string& engine, std::vector<Override>& changes) {
  if (engine.empty()) return;
  changes.push_back(parseOverride("render.engine=" + engine));
  changes.back().value.origin = std::make_shared<const ValueOrigin>(ValueOrigin{"--engine " + engine, ""});
}

void TakenPaths::addInput(const std::string& path, const std::string& what) {
  std::error_code error;
  taken_[fs::weakly_canonical(path, error).string()] = what;
}

void TakenPaths::addOutput(const OutputOption& option, const std::string& path) {
  if (path.empty()) return;
  checkOutputPath(option, path, "--" + option.name + " " + printable(path, 200));
  std::error_code error;
  const auto [other, isNew] = taken_.emplace(fs::weakly_canonical(path, error).string(), "--" + option.name);
  if (!isNew)
    throw usageError(
        fmt::format("--{} {} would overwrite {}", option.name, printable(path, 200), other->second),
        "a path of its own for each output");
  outputs_.push_back(other->first);
}

std::vector<OutputLock> TakenPaths::lock() const {
  std::vector<OutputLock> locks;
  for (const auto& output : outputs_) locks.emplace_back(output);
  return locks;
}

OutputOptions::OutputOptions(CLI::App& command, Program& program, bool replaysOnly) {
  for (auto& [name, kind, source] : program.registry().createServices<OutputKind>()) {
    if (replaysOnly && !showsReplays(*kind, name, source)) continue;
    Output output{
        .name = name, .source = source, .kind = {}, .options = optionsOf(*kind, name, source), .paths = {}};
    output.paths.resize(output.options.size());
    output.kind = std::move(kind);
    outputs_.push_back(std::move(output));
  }
  // The options write into the outputs, which stay where they are from now on.
  for (Output& output : outputs_)
    for (std::size_t i = 0; i < output.options.size(); ++i)
      command.add_option("--" + output.options[i].name, output.paths[i], output.options[i].doc)
          ->type_name(output.options[i].argument);
}

bool OutputOptions::any() const {
  for (const Output& output : outputs_)
    for (const std::string& path : output.paths)
      if (!path.empty()) return true;
  return false;
}

void OutputOptions::checkPaths(TakenPaths& taken) const {
  for (const Output& output : outputs_)
    for (std::size_t i = 0; i < output.options.size(); ++i)
      taken.addOutput(output.options[i], output.paths[i]);
}

OutputPaths OutputOptions::Output::given() const {
  OutputPaths given;
  for (std::size_t i = 0; i < options.size(); ++i)
    if (!paths[i].empty()) given[options[i].name] = paths[i];
  return given;
}

bool OutputOptions::Output::isByRanks(const Scene& scene, const Communicator& ranks) const {
  return ranks.size() > 1 && weir::isByRanks(*kind, name, source, scene);
}

bool OutputOptions::anyGathered(const Scene& scene, const Communicator& ranks) const {
  return std::ranges::any_of(outputs_, [&](const Output& output) {
    return !output.given().empty() && !output.isByRanks(scene, ranks);
  });
}

std::vector<std::unique_ptr<Observer>> OutputOptions::makeObservers(const Scene& scene,
                                                                    Communicator* ranks) const {
  std::vector<std::unique_ptr<Observer>> observers;
  for (const Output& output : outputs_) {
    const OutputPaths paths = output.given();
    if (paths.empty()) continue;
    const bool byRanks = ranks != nullptr && output.isByRanks(scene, *ranks);
    if (ranks != nullptr && ranks->rank() > 0 && !byRanks) continue;
    observers.push_back(
        makeGuardedObserver(*output.kind, output.name, output.source, paths, byRanks ? ranks : nullptr));
  }
  return observers;
}

void OutputOptions::print() const {
  for (const Output& output : outputs_)
    for (const std::string& path : output.paths)
      if (!path.empty()) app::print(path + "\n");
}

std::string OutputOptions::names() const {
  std::vector<std::string> names;
  for (const Output& output : outputs_)
    for (const OutputOption& option : output.options) names.push_back("--" + option.name);
  return joinNames(names);
}

}  // namespace weir::app
