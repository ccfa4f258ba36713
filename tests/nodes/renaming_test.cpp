// A name is what people call a node: it must not change what a run computes.
#include <gtest/gtest.h>

#include <regex>

#include "nodes/particle_fluid/particle_fluid.h"
#include "tests/support/devices.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

/// Two jets and two blocks with random arrangements; FIRST and SECOND stand for names.
constexpr const char* kScene = R"({
  "weir": 1,
  "world": { "gravity": [0, -9.8, 0], "dt": 0.002, "frame_rate": 50, "duration": 0.1, "seed": 3 },
  "nodes": {
    "FIRSTjet": { "type": "SquareEmitter", "params": {
      "position": [0, 1, 0], "width": 0.1, "height": 0.1, "speed": 2, "jitter": 0.3 } },
    "SECONDjet": { "type": "SquareEmitter", "params": {
      "position": [0.5, 1, 0], "width": 0.1, "height": 0.1, "speed": 2, "jitter": 0.3 } },
    "FIRSTblock": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.2, 0.2], "jitter": 0.2 } },
    "SECONDblock": { "type": "BoxSampler", "params": { "min": [0.5, 0, 0], "max": [0.7, 0.2, 0.2], "jitter": 0.2 } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.02, "support_ratio": 1.5 } }
  },
  "links": [ "FIRSTjet.particles -> water.emitters", "SECONDjet.particles -> water.emitters",
             "FIRSTblock.particles -> water.initial", "SECONDblock.particles -> water.initial" ]
})";

struct Places {
  std::vector<Vec3f> positions;
  std::vector<std::int64_t> ids;
  bool operator==(const Places&) const = default;
};

Places placesWhenNamed(Device& device, const std::string& first, const std::string& second,
                       const std::vector<std::string>& overrides = {}) {
  std::string text = std::regex_replace(kScene, std::regex("FIRST"), first);
  SimulatedScene scene(device, std::regex_replace(text, std::regex("SECOND"), second), overrides);
  scene->reset();
  while (scene->advanceFrame(false)) {
  }
  const ParticleSet& water = scene.node<ParticleFluid>("water").fluid->set();
  return {water.positions().toHost(scene->particleCount()), water.ids().toHost(scene->particleCount())};
}

TEST(Renaming, ANodeChangesNoBitOfARun) {
  for (const std::string& name : availableDevices()) {
    SCOPED_TRACE(name);
    const auto device = openDevice(name);
    const Places usual = placesWhenNamed(*device, "a", "b");
    ASSERT_GT(usual.ids.size(), 1500u);
    const Places renamed = placesWhenNamed(*device, "z", "y");
    EXPECT_EQ(renamed.ids, usual.ids);
    EXPECT_TRUE(renamed == usual);
  }
}

TEST(Renaming, NodesOfOneTypeStillDrawNumbersOfTheirOwn) {
  const auto device = openDevice("cpu");
  const auto usual = placesWhenNamed(*device, "a", "b");
  EXPECT_FALSE(placesWhenNamed(*device, "a", "b", {"ablock.seed=7", "bblock.seed=7"}) == usual);
  EXPECT_TRUE(placesWhenNamed(*device, "a", "b", {"ablock.seed=7", "bblock.seed=7"}) ==
              placesWhenNamed(*device, "a", "b", {"ablock.seed=7", "bblock.seed=7"}));
}

}  // namespace
}  // namespace weir::test
