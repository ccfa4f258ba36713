// Judges a scene that is being edited: what is wrong with it, and what it would change in a running
// simulation.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/error.h"
#include "framework/scene/scene_file.h"

namespace weir::studio {

/// An error as the page shows it: {message, allowed, hint, file, line, column, pointer, node, parameter,
/// part}; empty parts are left out.
Value problemOf(const Error& error);

struct CheckedScene {
  std::unique_ptr<Scene> scene;       ///< null if there is a problem
  std::optional<Value> problem;       ///< see problemOf
  std::vector<std::string> warnings;  ///< what is allowed but doubtful
};

/// Builds a scene whose relative paths are relative to `folder`; `file` is its name in messages. `alsoCheck`
/// may throw an Error for what else is wrong with it.
CheckedScene checkScene(const Value& root, const std::string& file, const std::string& folder,
                        const Registry& registry, const std::function<void(const Scene&)>& alsoCheck = {});

struct OpenedScene {
  Value scene;
  std::string warning;  ///< what saving would lose; "" if nothing
};

/// A scene file as it is edited: in plain form, where it has variables, expressions, units, included files or
/// repetition. One that cannot be built is given as it is, so that its mistake is shown.
OpenedScene readSceneFile(std::string_view text, const std::string& file, const std::string& folder,
                          const Registry& registry);

/// A new value of one parameter of a scene; the node is "world" for the world's.
struct LiveChange {
  std::string node;
  std::string module;  ///< "" for the node's own
  std::string parameter;
  Value value;
};

/// What turns the running scene into the next one. `live` holds what may change during a run; where anything
/// else differs, such as a link, `reset` names the first such thing. Title, layout and sections for outputs
/// do not count.
struct SceneDifference {
  std::vector<LiveChange> live;
  std::optional<std::string> reset;
};
SceneDifference differenceOf(const Scene& running, const Scene& next);

/// Makes a change in a running scene, between two steps. Throws a scene Error if the value is refused; the
/// old one then stands.
void apply(const LiveChange& change, Scene& running);

}  // namespace weir::studio
