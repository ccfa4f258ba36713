#include "apps/weir/validate_command.h"

#include "apps/weir/each_file.h"
#include "apps/weir/installed_scenes.h"
#include "apps/weir/standard_streams.h"
#include "framework/base/text.h"
#include "framework/run/simulation.h"

namespace weir::app {

namespace {

/// A file that a parameter names and that is not there would be found only when the simulation starts.
void checkFiles(const Configurable& owner, const std::string& node) {
  for (const Property* property : owner.properties()) {
    const auto* path = dynamic_cast<const Param<FilePath>*>(property);
    if (path == nullptr || path->get().empty()) continue;
    std::error_code error;
    if (std::filesystem::exists(path->get().resolved, error)) continue;
    throw ioError("there is no file " + inQuotes(path->get().resolved.string()))
        .at(property->origin())
        .inNode(node)
        .inParameter(property->name());
  }
}

void validateScene(Program& program, const std::string& file, const std::vector<std::string>& overrides) {
  std::vector<Override> changes;
  for (const std::string& text : overrides) changes.push_back(parseOverride(text));
  const std::unique_ptr<Scene> scene = program.load(sceneFile(file), changes);
  clockOf(*scene);
  for (const auto& node : scene->graph.nodes()) checkFiles(*node, node->name());
}

}  // namespace

ValidateCommand::ValidateCommand(CLI::App& app, Program& program)
    : program_(program), command_(app.add_subcommand("validate", "Check scenes without running them")) {
  command_->add_option("scenes", scenes_, "The scene files, or names of 'weir scenes'")
      ->required()
      ->type_name("SCENE...");
  command_->add_option("--set", set_, "Change a parameter first, as for 'weir run'")
      ->type_name("NAME=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  program_.addPluginPermission(*command_);
  program_.addPluginOption(*command_);
}

int ValidateCommand::run() {
  return forEachFile(program_, scenes_, [&](const std::string& file) {
    validateScene(program_, file, set_);
    print(file + ": valid\n");
    return kDone;
  });
}

}  // namespace weir::app
