#include "apps/weir/new_plugin_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "apps/weir/standard_streams.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestName = 40;
constexpr std::size_t kLargestTemplate = std::size_t{1} << 20;
constexpr const char* kAllowedName =
    "lower-case letters, digits and '_', starting with a letter, at most 40, such as vortex_force";

// The name becomes a namespace.
constexpr std::string_view kWordsOfCpp[] = {
    "alignas",  "alignof",   "and",       "and_eq",    "asm",       "auto",     "bitand",   "bitor",
    "bool",     "break",     "case",      "catch",     "char",      "class",    "compl",    "concept",
    "const",    "consteval", "constexpr", "constinit", "continue",  "decltype", "default",  "delete",
    "do",       "double",    "else",      "enum",      "explicit",  "export",   "extern",   "false",
    "float",    "for",       "friend",    "goto",      "if",        "inline",   "int",      "long",
    "main",     "mutable",   "namespace", "new",       "noexcept",  "not",      "not_eq",   "nullptr",
    "operator", "or",        "or_eq",     "private",   "protected", "public",   "register", "requires",
    "return",   "short",     "signed",    "sizeof",    "static",    "std",      "struct",   "switch",
    "template", "this",      "throw",     "true",      "try",       "typedef",  "typeid",   "typename",
    "union",    "unsigned",  "using",     "virtual",   "void",      "volatile", "weir",     "while",
    "xor",      "xor_eq"};

void checkName(const Program& program, const std::string& name) {
  const auto isLower = [](char c) { return c >= 'a' && c <= 'z'; };
  const bool plain = std::all_of(name.begin(), name.end(),
                                 [&](char c) { return isLower(c) || (c >= '0' && c <= '9') || c == '_'; });
  if (name.empty() || name.size() > kLongestName || !isLower(name.front()) || !plain)
    throw usageError(inQuotes(name) + " is not a valid name for a plugin", kAllowedName);
  if (std::find(std::begin(kWordsOfCpp), std::end(kWordsOfCpp), name) != std::end(kWordsOfCpp))
    throw usageError(inQuotes(name) + " is not a valid name for a plugin: it is a word of C++ or Weir's own",
                     kAllowedName);
  for (const Plugin& plugin : program.plugins())
    if (plugin.name() == name)
      throw usageError("there is a plugin " + inQuotes(name) + " already: " + plugin.file().string(),
                       "a name of its own for each");
}

/// "vortex_force" becomes "VortexForce".
std::string typeName(const std::string& name) {
  std::string result;
  bool upper = true;
  for (const char c : name) {
    if (c != '_') result += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    upper = c == '_';
  }
  return result;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

std::string named(const std::string& text, const std::string& name) {
  return replaced(replaced(text, "MyPlugin", typeName(name)), "my_plugin", name);
}

/// A copy of the template in `to`, which does not exist yet. All of it or, if an Error is thrown, nothing.
void writePlugin(const fs::path& from, const std::vector<fs::path>& files, const fs::path& to,
                 const std::string& name) {
  std::error_code error;
  try {
    for (const fs::path& file : files) {
      const fs::path copy = to / named(file.lexically_relative(from).string(), name);
      fs::create_directories(copy.parent_path(), error);
      if (error)
        throw ioError("the folder cannot be made: " + error.message())
            .at({.file = copy.parent_path().string()});
      writeFileAtomically(copy, named(readTextFile(file, kLargestTemplate), name));
    }
  } catch (const Error&) {
    fs::remove_all(to, error);
    throw;
  }
}

}  // namespace

NewPluginCommand::NewPluginCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand("new-plugin",
                                  "Write the project of a new plugin: a module, a node, a scene, a test")) {
  command_->add_option("name", name_, "Its name, such as vortex_force")->required()->type_name("NAME");
  command_->add_option("--directory", folder_, "The folder to make; ./NAME if it is left out")
      ->type_name("DIR");
}

int NewPluginCommand::run() {
  checkName(program_, name_);
  const fs::path from = dataFolder() / "templates/plugin", to = folder_.empty() ? name_ : folder_;
  std::error_code error;
  if (fs::symlink_status(to, error).type() != fs::file_type::not_found)
    throw ioError(inQuotes(to.string()) + " exists already", "a folder that does not exist yet");
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator entry(from, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->is_regular_file()) files.push_back(entry->path());
  if (error || files.empty())
    throw ioError("the template of plugins is not where this program expects it: " + from.string(), {},
                  "install Weir again, with its folder share/weir");

  writePlugin(from, files, to, name_);

  const fs::path prefix = dataFolder().parent_path().parent_path();
  if (!fs::exists(prefix / "lib/cmake/Weir/WeirConfig.cmake", error))
    program_.log().warn(
        "this Weir runs from its build folder, and plugins are built against an installed one: install it "
        "with "
        "cmake --install BUILD --prefix FOLDER, and name that folder below");
  const std::string place = to.string();
  const fs::path installed = prefix / "bin/weir";
  print(
      fmt::format("{0}\n\nBuild, test and run it:\n\n"
                  "  cmake -S {0} -B {0}/build -DCMAKE_PREFIX_PATH={1}\n"
                  "  cmake --build {0}/build\n"
                  "  ctest --test-dir {0}/build --output-on-failure\n"
                  "  {3} run {0}/scene.json --plugin {0}/build/plugins/weir_{2}.so\n",
                  place, prefix.string(), name_, fs::exists(installed, error) ? installed.string() : "weir"));
  return kDone;
}

}  // namespace weir::app
