#include "apps/weir/output_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "framework/base/text.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

/// "FILE.mp4 or FILE.mkv"
std::string allowedEndings(const OutputOption& option) {
  std::string text;
  for (const std::string& ending : option.extensions) text += (text.empty() ? "" : ", ") + ending;
  return "a file that ends in " + text;
}

void checkPath(const OutputOption& option, const std::string& text) {
  const std::string what = "--" + option.name + " " + printable(text, 200);
  const fs::path path = text;
  if (!option.isFolder()) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (std::find(option.extensions.begin(), option.extensions.end(), ending) == option.extensions.end())
      throw usageError(what + (ending.empty() ? " has no ending" : " ends in " + printable(ending)),
                       allowedEndings(option));
  }
  std::error_code error;
  const fs::path above = fs::absolute(path).lexically_normal().parent_path();
  if (!fs::is_directory(above, error))
    throw ioError(what + ": there is no folder " + inQuotes(above.string()),
                  "a path in a folder that exists");
}

}  // namespace

void TakenPaths::addInput(const std::string& path, const std::string& what) {
  std::error_code error;
  taken_[fs::weakly_canonical(path, error).string()] = what;
}

void TakenPaths::addOutput(const OutputOption& option, const std::string& path) {
  if (path.empty()) return;
  checkPath(option, path);
  std::error_code error;
  const auto [other, isNew] = taken_.emplace(fs::weakly_canonical(path, error).string(), "--" + option.name);
  if (!isNew)
    throw usageError(
        fmt::format("--{} {} would overwrite {}", option.name, printable(path, 200), other->second),
        "a path of its own for each output");
}

OutputOptions::OutputOptions(CLI::App& command, Program& program, bool replaysOnly) {
  for (auto& [name, kind] : program.registry().createServices<OutputKind>()) {
    if (replaysOnly && !kind->showsReplays()) continue;
    Output output;
    output.options = kind->options();
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

std::vector<std::unique_ptr<Observer>> OutputOptions::makeObservers() const {
  std::vector<std::unique_ptr<Observer>> observers;
  for (const Output& output : outputs_) {
    OutputPaths paths;
    for (std::size_t i = 0; i < output.options.size(); ++i)
      if (!output.paths[i].empty()) paths[output.options[i].name] = output.paths[i];
    if (!paths.empty()) observers.push_back(output.kind->create(paths));
  }
  return observers;
}

void OutputOptions::print() const {
  for (const Output& output : outputs_)
    for (const std::string& path : output.paths)
      if (!path.empty()) fmt::print("{}\n", path);
}

std::string OutputOptions::names() const {
  std::vector<std::string> names;
  for (const Output& output : outputs_)
    for (const OutputOption& option : output.options) names.push_back("--" + option.name);
  return joinNames(names);
}

}  // namespace weir::app
