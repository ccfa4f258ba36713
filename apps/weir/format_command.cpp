#include "apps/weir/format_command.h"

#include "apps/weir/each_file.h"
#include "apps/weir/standard_streams.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"
#include "framework/scene/layout.h"

namespace weir::app {

FormatCommand::FormatCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand(
          "format", "Write scene files in Weir's layout; comments, expressions and order stay")) {
  command_->add_option("files", files_, "Scene files, or files that scenes include")
      ->required()
      ->type_name("FILE...");
  CLI::Option* check =
      command_->add_flag("--check", check_, "Change nothing; exit code 1 if a file has another layout");
  command_->add_flag("--stdout", toStandardOutput_, "Print the text of one file, and leave the file as it is")
      ->excludes(check);
}

int FormatCommand::format(const std::string& file) const {
  const std::string text = readTextFile(file, kLargestSceneFile);
  const std::string formatted = formattedScene(text, file);
  if (toStandardOutput_) {
    print(formatted);
    return kDone;
  }
  if (formatted == text) return kDone;
  if (!check_) replaceFileAtomically(file, formatted);
  print(printable(file, 2000) + (check_ ? ": has another layout\n" : ": formatted\n"));
  return check_ ? kWouldChange : kDone;
}

int FormatCommand::run() {
  if (toStandardOutput_ && files_.size() > 1) throw usageError("--stdout is for one file", "one FILE");
  return forEachFile(program_, files_, [this](const std::string& file) { return format(file); });
}

}  // namespace weir::app
