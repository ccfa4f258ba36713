// A scene with all nodes of the project, from text to a simulation, and what it warned of.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/run/simulation.h"
#include "framework/scene/scene_file.h"
#include "nodes/register_nodes.h"

namespace weir::test {

class SimulatedScene {
 public:
  /// `overrides` as for --set: "world.dt=0.01"; `addMore` adds what plugins would.
  SimulatedScene(Device& device, const std::string& text, const std::vector<std::string>& overrides = {},
                 const std::function<void(Registry&)>& addMore = {}) {
    registerNodes(registry_);
    if (addMore) addMore(registry_);
    std::vector<Override> changes;
    for (const std::string& change : overrides) changes.push_back(parseOverride(change));
    std::vector<std::string> ignored;
    auto scene = buildScene(parseJson(text, "s.json"), {"s.json", "", "/"}, registry_, changes, ignored);
    simulation_ = std::make_unique<Simulation>(std::move(scene), device, log_, registry_);
  }

  Simulation& operator*() { return *simulation_; }
  Simulation* operator->() { return simulation_.get(); }
  template <class N>
  N& node(const char* name) {
    return dynamic_cast<N&>(*simulation_->scene().graph.find(name));
  }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::vector<std::string> warnings_;
  Log log_{[this](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarning) warnings_.emplace_back(text);
  }};
  Registry registry_;
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace weir::test
