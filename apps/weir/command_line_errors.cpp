#include "apps/weir/command_line_errors.h"

#include <algorithm>

#include "framework/base/text.h"
#include "framework/base/value.h"

namespace weir::app {

namespace {

constexpr const char* kHelp =
    "'weir --help' and 'weir COMMAND --help' list what there is; options for outputs come from plugins, see "
    "'weir info'";

std::vector<std::string> commandsOf(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* known : app.get_subcommands({})) names.push_back(known->get_name());
  return names;
}

std::vector<std::string> optionsOf(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options({}))
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Of a command to which nobody listened.
Error unexpected(const CLI::App& command, const std::vector<std::string>& left) {
  const auto option =
      std::find_if(left.begin(), left.end(), [](const std::string& word) { return word.starts_with('-'); });
  if (option == left.end())
    return usageError("'weir " + command.get_name() + "' does not take " + inQuotes(left.front()), {}, kHelp);
  const std::string name = option->substr(0, option->find('='));
  const std::string meant = didYouMean(name, optionsOf(command));
  return usageError("'weir " + command.get_name() + "' has no option " + inQuotes(name), {},
                    meant.empty() ? kHelp : meant);
}

/// Of a command, where `what` is "NAME is required".
Error missing(const CLI::App& command, const std::string& what) {
  const std::string name = what.substr(0, what.find(" is required"));
  const CLI::Option* option = command.get_option_no_throw(name);
  if (option == nullptr) return usageError(what, {}, kHelp);
  const std::string values = option->get_type_name();
  return usageError(
      "'weir " + command.get_name() + "' needs " + (option->get_positional() ? values : name + " " + values),
      {}, kHelp);
}

}  // namespace

void checkCommand(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments.front().starts_with('-')) return;
  const std::string& command = arguments.front();
  const std::vector<std::string> names = commandsOf(app);
  if (std::find(names.begin(), names.end(), command) == names.end())
    throw usageError("there is no command " + inQuotes(command), joinNames(names),
                     didYouMean(command, names));
}

Error commandLineError(const CLI::App& app, const CLI::ParseError& thrown) {
  const std::vector<CLI::App*> typed = app.get_subcommands();
  const bool required = dynamic_cast<const CLI::RequiredError*>(&thrown) != nullptr;
  if (typed.empty() && required)
    return usageError("no command is given", joinNames(commandsOf(app)), "'weir --help' tells what they do");
  if (required) return missing(*typed.front(), thrown.what());
  if (!typed.empty() && dynamic_cast<const CLI::ExtrasError*>(&thrown) != nullptr)
    if (const std::vector<std::string> left = typed.front()->remaining(); !left.empty())
      return unexpected(*typed.front(), left);
  return usageError(thrown.what(), {}, kHelp);
}

CLI::Validator notNegative() {
  const auto check = [](const std::string& text) {
    double number = 0;
    const bool right = CLI::detail::lexical_cast(text, number) && number >= 0;
    return right ? std::string() : inQuotes(text) + " is not a number of at least 0";
  };
  return CLI::Validator(check, "", "");
}

}  // namespace weir::app
