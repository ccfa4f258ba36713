// What every command of the program needs: the log, the registry, and the plugins.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/base/log.h"
#include "framework/graph/plugin.h"
#include "framework/graph/registry.h"
#include "framework/scene/scene_file.h"

namespace CLI {
class App;
}

namespace weir::app {

/// The folders that are searched for plugins: those of the environment variable WEIR_PLUGIN_PATH, separated
/// by
/// ':', then lib/weir/plugins beside the program's own folder.
std::vector<std::filesystem::path> pluginFolders();

/// The folder of data files that come with the program, share/weir beside the program's own folder.
std::filesystem::path dataFolder();

class Program {
 public:
  Program();

  Log& log() { return log_; }
  Registry& registry() { return registry_; }
  const std::vector<Plugin>& plugins() const { return plugins_; }

  /// Loads what is in pluginFolders(). A plugin there that cannot be loaded is a warning, so that one broken
  /// file does not keep everyone from working.
  void loadInstalledPlugins();
  /// Loads one that was asked for; throws if it cannot be loaded. One that is loaded already is left as it
  /// is.
  void loadPlugin(const std::filesystem::path& file);

  /// Adds --plugin to a command, for its help: main() has loaded these before.
  void addPluginOption(CLI::App& command);
  /// Adds --allow-plugins to a command that reads scenes.
  void addPluginPermission(CLI::App& command);

  /// Reads a scene with the plugins that it names, and warns of what is doubtful in it. A plugin is code:
  /// without
  /// --allow-plugins, throws a scene Error if the scene names one that is neither loaded already nor in one
  /// of pluginFolders().
  std::unique_ptr<Scene> load(const std::filesystem::path& file, const std::vector<Override>& overrides);
  /// The same with a scene whose text is part of the program; `name` is for messages.
  std::unique_ptr<Scene> loadText(const std::string& name, std::string_view text,
                                  const std::vector<Override>& overrides);

  /// Loads the plugins that a scene names, or throws, as load() does.
  PluginLoader pluginLoader(const std::filesystem::path& scene) {
    return [this, scene](const std::vector<FilePath>& plugins) { loadPluginsOf(scene, plugins); };
  }

  /// Called before a message is written, to make room for it on a terminal.
  void beforeMessage(std::function<void()> action) { beforeMessage_ = std::move(action); }
  /// Whether messages below warnings are shown.
  void setQuiet(bool quiet) { quiet_ = quiet; }

 private:
  bool isLoaded(const std::filesystem::path& file) const;
  void loadPluginsOf(const std::filesystem::path& scene, const std::vector<FilePath>& plugins);

  std::function<void()> beforeMessage_;
  bool quiet_ = false;
  bool allowsPlugins_ = false;
  std::vector<std::string> namedPlugins_;
  Log log_;
  std::vector<Plugin> plugins_;  // before the registry, which holds functions of theirs
  Registry registry_;
};

}  // namespace weir::app
