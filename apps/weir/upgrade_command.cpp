#include "apps/weir/upgrade_command.h"

#include "apps/weir/each_file.h"
#include "apps/weir/standard_streams.h"
#include "framework/base/file_output.h"
#include "framework/scene/upgrade.h"

namespace weir::app {

namespace {

void write(const std::vector<UpgradedFile>& files) {
  // A scene of which only a part is changed may be none: first see whether all can be written.
  for (const UpgradedFile& file : files) checkReplaceable(file.file);
  for (const UpgradedFile& file : files) replaceFileAtomically(file.file, file.text);
}

}  // namespace

UpgradeCommand::UpgradeCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand("upgrade", "Bring old names in scenes to those of today; all else stays")) {
  command_->add_option("files", files_, "Scene files; files that they include are changed, too")
      ->required()
      ->type_name("SCENE...");
  command_->add_flag("--check", check_, "Change nothing; exit code 1 if there is something to change");
  program_.addPluginPermission(*command_);
}

int UpgradeCommand::upgrade(const std::string& file) {
  const Upgrade upgrade = upgradeOf(file, program_.registry(), program_.pluginLoader(file));
  if (!check_) write(upgrade.files);
  for (const std::string& change : upgrade.changes) print(change + "\n");
  return check_ && !upgrade.files.empty() ? kWouldChange : kDone;
}

int UpgradeCommand::run() {
  return forEachFile(program_, files_, [this](const std::string& file) { return upgrade(file); });
}

}  // namespace weir::app
