#include "apps/weir/completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace weir::app {

namespace {

/// Whether its argument may be the name of a scene that comes with Weir.
bool takesScene(const CLI::App& command) {
  for (const std::string name : {"run", "sweep", "validate", "explain", "scenes"})
    if (command.get_name() == name) return true;
  return false;
}

}  // namespace

std::string bashCompletion(const CLI::App& app, const std::vector<std::string>& scenes) {
  std::string commands, cases;
  for (const CLI::App* command : app.get_subcommands({})) {
    commands += (commands.empty() ? "" : " ") + command->get_name();
    std::string options;
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : option->get_lnames()) options += (options.empty() ? "--" : " --") + name;
    cases += fmt::format("    {}) options=\"{}\"{} ;;\n", command->get_name(), options,
                         takesScene(*command) ? "; scenes=\"$installed\"" : "");
  }
  return fmt::format(
      "# Put this into your shell:  source <(weir completion)\n"
      "_weir() {{\n"
      "  local word=\"${{COMP_WORDS[COMP_CWORD]}}\" options=\"\" scenes=\"\"\n"
      "  local installed=\"{}\"\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W \"{}\" -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case \"${{COMP_WORDS[1]}}\" in\n"
      "{}"
      "  esac\n"
      "  case \"$word\" in\n"
      "    -*) COMPREPLY=($(compgen -W \"$options\" -- \"$word\")) ;;\n"
      "    *) COMPREPLY=($(compgen -f -- \"$word\"; compgen -W \"$scenes\" -- \"$word\")) ;;\n"
      "  esac\n"
      "}}\n"
      "complete -o filenames -F _weir weir\n",
      fmt::join(scenes, " "), commands, cases);
}

}  // namespace weir::app
