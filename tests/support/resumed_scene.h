// Whether a scene that is resumed goes on as if it had never ended, from its text.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/run/resume_check.h"
#include "framework/scene/scene_file.h"
#include "nodes/register_nodes.h"
#include "tests/support/devices.h"

namespace weir::test {

/// resumeDifferences() on two threads of the CPU; `overrides` and `addMore` as for SimulatedScene.
inline std::vector<std::string> resumedSceneDifferences(const std::string& text,
                                                        const ResumeCheck& check = {},
                                                        const std::vector<std::string>& overrides = {},
                                                        const std::function<void(Registry&)>& addMore = {}) {
  const auto device = openDevice("cpu", 2);
  Log log;
  Registry registry;
  registerNodes(registry);
  if (addMore) addMore(registry);
  std::vector<Override> changes;
  for (const std::string& change : overrides) changes.push_back(parseOverride(change));
  const auto make = [&] {
    std::vector<std::string> ignored;
    auto scene = buildScene(parseJson(text, "s.json"), {"s.json", "", "/"}, registry, changes, ignored);
    return std::make_unique<Simulation>(std::move(scene), *device, log, registry);
  };
  return resumeDifferences(make, check);
}

}  // namespace weir::test
