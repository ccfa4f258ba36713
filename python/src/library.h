// What there is to build scenes from: Weir's own types, those of plugins, and those that Python registers.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <string>
#include <vector>

#include "framework/graph/plugin.h"
#include "framework/graph/registry.h"

namespace weir::python {

namespace nb = nanobind;

class Library {
 public:
  Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  /// As it is now. What is added later makes another one, so that this may be read by any thread.
  const std::shared_ptr<const Registry>& registry() const { return registry_; }

  /// Nothing happens if it is loaded already. Throws as Plugin does.
  void loadPlugin(const std::string& file);
  /// Files of the plugins that are loaded.
  std::vector<std::string> plugins() const;
  /// Makes a class that derives from weir.Module or weir.Node known by its name, for scenes that are read
  /// from files.
  void registerModule(nb::object type);
  void registerNode(nb::object type);

 private:
  std::shared_ptr<const Registry> registry_;
  std::vector<Plugin> plugins_;
};

/// lib/weir/plugins beside the libraries that this extension uses: of the build tree, or of the package.
std::string ownPluginFolder();

void bindLibrary(nb::module_& m);

}  // namespace weir::python
