#include "apps/studio/session/scene_check.h"

#include <algorithm>
#include <set>

#include "framework/base/text.h"

namespace weir::studio {

namespace {

void putText(Value& object, const std::string& key, const std::string& text) {
  if (!text.empty()) object[key] = text;
}

std::set<std::string> linksOf(const Scene& scene) {
  std::set<std::string> links;
  for (const Link& link : scene.graph.links()) links.insert(link.text());
  return links;
}

/// Collects what differs between two scenes, parameter by parameter.
class Comparison {
 public:
  void parameters(const Configurable& running, const Configurable& next, const LiveChange& where) {
    for (std::size_t i = 0; i < running.properties().size(); ++i) {
      const Property& old = *running.properties()[i];
      const Property& now = *next.properties()[i];
      if (old.value() == now.value()) continue;
      LiveChange change = where;
      change.parameter = old.name();
      change.value = now.value();
      if (old.spec().live)
        found.live.push_back(std::move(change));
      else
        needsReset(where.node + (where.module.empty() ? "" : "." + where.module) + "." + old.name());
    }
  }

  void pipelines(const PipelineBase& running, const PipelineBase& next, const std::string& node) {
    const auto& old = running.modules();
    const auto& now = next.modules();
    const auto alike = [](const auto& a, const auto& b) {
      return a->name() == b->name() && a->info().type == b->info().type && a->enabled() == b->enabled();
    };
    if (!std::equal(old.begin(), old.end(), now.begin(), now.end(), alike))
      return needsReset("the modules of " + node);
    for (std::size_t i = 0; i < old.size(); ++i)
      parameters(*old[i], *now[i], {.node = node, .module = old[i]->name(), .parameter = {}, .value = {}});
  }

  void nodes(const Scene& running, const Scene& next) {
    if (running.graph.nodes().size() != next.graph.nodes().size()) return needsReset("the nodes");
    for (const auto& old : running.graph.nodes()) {
      Node* now = next.graph.find(old->name());
      if (now == nullptr || now->info().type != old->info().type) return needsReset(old->name());
      parameters(*old, *now, {.node = old->name(), .module = {}, .parameter = {}, .value = {}});
      if (old->pipeline() != nullptr) pipelines(*old->pipeline(), *now->pipeline(), old->name());
    }
  }

  void needsReset(const std::string& what) {
    if (!found.reset) found.reset = what;
  }

  SceneDifference found;
};

}  // namespace

Value problemOf(const Error& error) {
  Value v = Value::object();
  const Location& at = error.location();
  putText(v, "message", error.message());
  putText(v, "allowed", error.allowed());
  putText(v, "hint", error.hint());
  putText(v, "file", at.file);
  if (at.line > 0) v["line"] = at.line;
  if (at.column > 0) v["column"] = at.column;
  putText(v, "pointer", at.pointer);
  putText(v, "node", at.node);
  putText(v, "parameter", at.parameter);
  putText(v, "part", at.part);
  return v;
}

CheckedScene checkScene(const Value& root, const std::string& file, const std::string& folder,
                        const Registry& registry, const std::function<void(const Scene&)>& alsoCheck) {
  CheckedScene checked;
  try {
    auto scene = buildScene(root, Place{file, "", folder}, registry, {}, checked.warnings);
    if (alsoCheck) alsoCheck(*scene);
    scene->text = textToKeep(writeJson(root), root, *scene);
    checked.scene = std::move(scene);
  } catch (const Error& e) {
    checked.problem = problemOf(e);
  }
  return checked;
}

OpenedScene readSceneFile(std::string_view text, const std::string& file, const std::string& folder,
                          const Registry& registry) {
  OpenedScene opened{parseScene(text, file), {}};
  const WrittenForm form = writtenForm(text, opened.scene);
  if (form.shorthand) {
    CheckedScene checked = checkScene(opened.scene, file, folder, registry);
    if (!checked.scene) return opened;
    opened.scene = sceneToValue(*checked.scene);
  }
  if (form.shorthand)
    opened.warning =
        inQuotes(file) +
        " has variables, expressions, units, included files or repeated parts, which the studio "
        "shows as plain numbers and nodes: saving to this name writes the scene without them, and "
        "without comments and notes; save under another name to keep the file";
  else if (form.comments)
    opened.warning = inQuotes(file) +
                     " has comments or trailing commas: saving to this name writes the scene without them; "
                     "save under another name to keep the file";
  return opened;
}

SceneDifference differenceOf(const Scene& running, const Scene& next) {
  Comparison comparison;
  comparison.nodes(running, next);
  if (linksOf(running) != linksOf(next)) comparison.needsReset("the links");
  comparison.parameters(running.world, next.world,
                        {.node = "world", .module = {}, .parameter = {}, .value = {}});
  return std::move(comparison.found);
}

void apply(const LiveChange& change, Scene& running) {
  Configurable* owner = &running.world;
  if (change.node != "world") {
    Node* node = running.graph.find(change.node);
    WEIR_CHECK(node != nullptr);
    owner = change.module.empty() ? static_cast<Configurable*>(node) : node->pipeline()->find(change.module);
  }
  Value values = Value::object();
  values[change.parameter] = change.value;
  owner->assignAll(values, {});
}

}  // namespace weir::studio
