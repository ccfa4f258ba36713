#include "apps/weir/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "apps/weir/program_file.h"
#include "framework/base/interruption.h"
#include "framework/base/text.h"
#include "framework/graph/plugin_probe.h"
#include "nodes/register_nodes.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

/// The installation or build tree that the program runs from: the folder above bin/.
fs::path prefix() {
  return programFile().parent_path().parent_path();
}

bool isInPluginFolder(const fs::path& file) {
  std::error_code error;
  const fs::path folder = fs::absolute(file, error).parent_path();
  const std::vector<fs::path> folders = pluginFolders();
  return std::any_of(folders.begin(), folders.end(),
                     [&](const fs::path& trusted) { return fs::equivalent(folder, trusted, error); });
}

}  // namespace

std::vector<fs::path> pluginFolders() {
  std::vector<fs::path> folders;
  const char* variable = std::getenv("WEIR_PLUGIN_PATH");
  std::string_view rest = variable != nullptr ? variable : "";
  while (!rest.empty()) {
    const auto colon = rest.find(':');
    if (colon != 0) folders.emplace_back(rest.substr(0, colon));
    rest.remove_prefix(colon == std::string_view::npos ? rest.size() : colon + 1);
  }
  folders.push_back(prefix() / "lib/weir/plugins");
  return folders;
}

fs::path dataFolder() {
  return prefix() / "share/weir";
}

Program::Program()
    : log_([this, sink = stderrSink()](LogLevel level, std::string_view message) {
        if (quiet_ && level < LogLevel::kWarning) return;
        if (beforeMessage_) beforeMessage_();
        sink(level, message);
      }) {
  registerNodes(registry_);
}

bool Program::isLoaded(const fs::path& file) const {
  for (const Plugin& plugin : plugins_) {
    std::error_code error;
    if (fs::equivalent(plugin.file(), file, error)) return true;
  }
  return false;
}

void Program::loadInstalledPlugins() {
  for (const fs::path& folder : pluginFolders())
    for (const fs::path& file : pluginFiles(folder)) {
      try {
        loadPlugin(file);
      } catch (const Error& e) {
        log_.warn(std::string("going on without a plugin: ") + e.what());
      }
    }
}

void Program::loadPlugin(const fs::path& file) {
  if (isLoaded(file)) return;
  probePlugin(file);
  plugins_.emplace_back(file, registry_);
}

void Program::addPluginOption(CLI::App& command) {
  command.add_option("--plugin", namedPlugins_, "Load this plugin; may be repeated")
      ->type_name("LIB")
      ->take_all()
      ->allow_extra_args(false);
}

void Program::addPluginPermission(CLI::App& command) {
  command.add_flag("--allow-plugins", allowsPlugins_,
                   "Load the plugins that the scene names: their code runs with all that you may do");
}

void Program::loadPluginsOf(const fs::path& scene, const std::vector<FilePath>& plugins) {
  for (std::size_t i = 0; i < plugins.size(); ++i) {
    const FilePath& plugin = plugins[i];
    if (!allowsPlugins_ && !isLoaded(plugin.resolved) && !isInPluginFolder(plugin.resolved))
      throw sceneError(
          "the scene asks for the plugin " + inQuotes(plugin.text) + ", whose code would run",
          "plugins that --plugin names, or in a folder of WEIR_PLUGIN_PATH, or installed with Weir",
          "if you trust the scene, --allow-plugins loads the plugins that it names")
          .at({.file = scene.string(), .pointer = "/plugins/" + std::to_string(i)});
    loadPlugin(plugin.resolved);
  }
}

std::unique_ptr<Scene> Program::load(const fs::path& file, const std::vector<Override>& overrides) {
  const InterruptibleWork work;
  std::vector<std::string> warnings;
  std::unique_ptr<Scene> scene = loadScene(file, registry_, overrides, warnings, pluginLoader(file));
  for (const std::string& warning : warnings) log_.warn(warning);
  return scene;
}

std::unique_ptr<Scene> Program::loadText(const std::string& name, std::string_view text,
                                         const std::vector<Override>& overrides) {
  std::vector<std::string> warnings;
  const Value root = parseScene(text, name);
  std::unique_ptr<Scene> scene = buildScene(root, Place{name, "", ""}, registry_, overrides, warnings);
  for (const std::string& warning : warnings) log_.warn(warning);
  scene->text = textToKeep(std::string(text), root, *scene);
  return scene;
}

}  // namespace weir::app
