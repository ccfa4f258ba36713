#include "apps/weir/scenes_command.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "apps/weir/installed_scenes.h"
#include "apps/weir/standard_streams.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"
#include "framework/run/progress.h"
#include "framework/run/simulation.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongest = 300;  // of texts of a scene

std::string titleOf(const fs::path& file) {
  const Value scene = parseScene(readTextFile(file, kLargestSceneFile), file.string());
  const Value* title = scene.find("title");
  return title != nullptr && title->isString() ? printable(title->asString(), kLongest) : std::string();
}

}  // namespace

ScenesCommand::ScenesCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(
          app.add_subcommand("scenes", "List the scenes that come with Weir, or begin one's own with one")) {
  command_->add_option("name", name_, "Tell of this scene only; 'weir run NAME' runs it")->type_name("NAME");
  command_->add_option("--copy", copy_, "Write a copy of the scene NAME, to be changed")
      ->type_name("FILE.json");
}

std::string ScenesCommand::particlesOf(const std::string& name) {
  try {
    Log silent;
    std::vector<std::string> warnings;
    const std::unique_ptr<Device> device = openDevice("cpu");
    Simulation simulation(loadScene(installedScene(name), program_.registry(), {}, warnings), *device, silent,
                          program_.registry());
    const double particles = simulation.estimate().total().particles;
    return fmt::format("up to {} particles", groupedText(std::llround(particles)));
  } catch (const Error& e) {
    return "it does not run as it is: " + e.message();
  }
}

std::string ScenesCommand::listed() {
  std::string text;
  for (const std::string& name : installedScenes()) {
    text += fmt::format("{}\n    {}; {}\n", name, titleOf(installedScene(name)), particlesOf(name));
    if (const std::string description = descriptionOf(name); !description.empty())
      text += fmt::format("    {}\n", printable(description, kLongest));
  }
  if (text.empty()) return fmt::format("There are no scenes in {}.\n", sceneFolder().string());
  return text + fmt::format(
                    "\nThey are in {}.\n'weir run NAME' runs one, and 'weir scenes NAME --copy FILE.json' "
                    "begins a scene of your own.\n",
                    sceneFolder().string());
}

std::string ScenesCommand::told(const std::string& name) {
  const fs::path file = installedScene(name);
  std::string text = fmt::format("{}\n  title: {}\n", name, titleOf(file));
  if (const std::string description = descriptionOf(name); !description.empty())
    text += fmt::format("  description: {}\n", printable(description, kLongest));
  return text + fmt::format("  size: {}\n  file: {}\n", particlesOf(name), file.string());
}

void ScenesCommand::copy() const {
  const std::string text = readTextFile(installedScene(name_), kLargestSceneFile);
  std::error_code error;
  if (fs::exists(fs::symlink_status(copy_, error)))
    throw ioError("there is a file already, which would be overwritten", "a path where nothing is")
        .at({.file = copy_});
  writeFileAtomically(copy_, text);
  print(copy_ + "\n");
}

int ScenesCommand::run() {
  if (name_.empty() && !copy_.empty())
    throw usageError("--copy does not say of which scene", "weir scenes NAME --copy FILE.json");
  if (!copy_.empty())
    copy();
  else
    print(name_.empty() ? listed() : told(name_));
  return kDone;
}

}  // namespace weir::app
