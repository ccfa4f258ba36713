#include "apps/weir/about_commands.h"

#include "apps/weir/completion.h"
#include "apps/weir/describe.h"
#include "apps/weir/describe_file.h"
#include "apps/weir/installed_scenes.h"
#include "apps/weir/standard_streams.h"
#include "framework/scene/scene_file.h"
namespace weir::app {

AboutCommands::AboutCommands(CLI::App& app, Program& program) : app_(app), program_(program) {
  addNodes();
  schema_ = app.add_subcommand("schema", "Print the JSON Schema of scene files");
  addInfo();
  completion_ = app.add_subcommand("completion", "Print a script for completion in bash");
  for (CLI::App* command : {nodes_, schema_, info_}) program.addPluginOption(*command);
}

void AboutCommands::addNodes() {
  nodes_ = app_.add_subcommand("nodes", "List the types of nodes and modules, or tell all of one");
  nodes_->add_option("type", type_, "A node or module type")->type_name("TYPE");
  nodes_->add_flag("--json", json_, "Print JSON");
}

void AboutCommands::addInfo() {
  info_ = app_.add_subcommand(
      "info", "Show version, devices and plugins; or what files hold, and whether they are whole");
  info_->add_option("files", files_, "Checkpoints, exports, meshes or files of particles")
      ->type_name("FILE...");
  info_->add_flag("--scene", sceneOnly_, "Print the scene that a file holds, and nothing else");
}

int AboutCommands::tellOfTypes() const {
  const Registry& registry = program_.registry();
  if (json_)
    print(writeJson(typesAsValue(registry, type_)));
  else
    print(type_.empty() ? describeAll(registry) : describeType(registry, type_));
  return kDone;
}

int AboutCommands::tellOfProgramOrFiles() const {
  if (!files_.empty()) return describeFiles(program_, files_, sceneOnly_);
  if (sceneOnly_) throw usageError("--scene needs a file", "a checkpoint, or an export that Weir wrote");
  print(describeProgram(program_, program_.registry()));
  return kDone;
}

int AboutCommands::run() {
  if (nodes_->parsed()) return tellOfTypes();
  if (info_->parsed()) return tellOfProgramOrFiles();
  if (schema_->parsed()) print(writeJson(sceneSchema(program_.registry())));
  if (completion_->parsed()) print(bashCompletion(app_, installedScenes()));
  return kDone;
}

}  // namespace weir::app
