// Modules work on attributes while a fluid comes to rest, before time 0. None of that may be left at time 0.
#include <gtest/gtest.h>

#include <algorithm>

#include "framework/run/simulation.h"
#include "framework/scene/scene_file.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/register_nodes.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

/// Two particles above the water that bring the attribute "heat".
class HotDrops final : public Node {
 public:
  static constexpr NodeInfo kInfo{"HotDrops", "Two warm particles."};
  const NodeInfo& info() const override { return kInfo; }
  Output<ParticleBatch> particles{*this, "particles", "They."};
  void reset(const SetupContext& context) override {
    particles->assign(context.device, std::vector<Vec3f>{{0.03f, 0.15f, 0.05f}, {0.07f, 0.15f, 0.05f}},
                      Vec3f{});
    particles->attributes.clear();
    particles->attributes.push_back({{.name = "heat", .unit = "J", .doc = "Heat."},
                                     Array<float>(context.device, std::vector<float>{40, 20})});
  }
};

/// Cools all particles by 1 J in each step, and counts the steps of each, as it must not do with the fluid at
/// rest before the start.
class Cooling final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{"Cooling", kFamily, "Cools, and counts steps."};
  const ModuleInfo& info() const override { return kInfo; }
  void reset(FluidStep& fluid) override {
    heat_ = fluid.particles.add<float>({"heat", AttributeType::kFloat, "J", "Heat."});
    steps_ = fluid.particles.add<int>({"steps", AttributeType::kInt, "", "Steps."});
    steps_.fillZero();
  }
  void step(FluidStep& fluid) override {
    const std::int64_t count = fluid.particles.refreshCount();
    std::vector<float> heat = heat_.toHost(count);
    std::vector<int> steps = steps_.toHost(count);
    for (float& h : heat) h -= 1;
    for (int& s : steps) ++s;
    heat_.assign(heat);
    steps_.assign(steps);
  }

 private:
  Attribute<float> heat_;
  Attribute<int> steps_;
};

constexpr const char* kScene = R"({"weir": 1,
  "world": {"dt": 0.001, "frame_rate": 1000, "duration": 0.01},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.1, 0.1, 0.1]}},
    "drops": {"type": "HotDrops"},
    "tank": {"type": "StaticBoundary", "params": {"shape": "box", "min": [0, 0, 0], "max": [0.1, 0.2, 0.1], "inverted": true}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.02},
              "modules": {"cooling": {"type": "Cooling", "before": "predict"}}}},
  "links": ["block.particles -> water.initial", "drops.particles -> water.initial", "tank.boundary -> water.boundaries"]})";

TEST(RestAttributes, AreThoseOfTheSamplersAtTheStart) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    Log log{[](LogLevel, std::string_view) {}};
    Registry registry;
    registerNodes(registry);
    registry.addNode<HotDrops>();
    registry.addModule<Cooling>();
    std::vector<std::string> warnings;
    Simulation simulation(buildScene(parseJson(kScene, "test"), {"test", "", "."}, registry, {}, warnings),
                          *device, log, registry);
    simulation.reset();
    auto& water = dynamic_cast<ParticleFluid&>(*simulation.scene().graph.find("water"));
    NodeReport report;
    water.report(report);
    ASSERT_GT(report.statistics["rest_steps"].asInt(), 10) << name;

    const ParticleSet& particles = water.fluid->set();
    const auto count = water.particleCount();
    std::vector<float> heat = particles.get<float>("heat").toHost(count);
    std::sort(heat.begin(), heat.end());
    ASSERT_EQ(heat.size(), 5u * 5 * 5 + 2);
    EXPECT_EQ(heat[heat.size() - 1], 40) << name;
    EXPECT_EQ(heat[heat.size() - 2], 20) << name;
    EXPECT_EQ(heat.front(), 0) << name;
    EXPECT_EQ(particles.get<int>("steps").toHost(count), std::vector<int>(heat.size(), 0)) << name;
  }
}

}  // namespace
}  // namespace weir::test
