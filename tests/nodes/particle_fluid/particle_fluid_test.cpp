// The node: growth from nothing, removal, parameters, pipelines, two scenes side by side.
#include "nodes/particle_fluid/particle_fluid.h"

#include <gtest/gtest.h>

#include "nodes/emitters/square_emitter.h"
#include "tests/support/devices.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

TEST(ParticleFluid, StartsEmptyAndGrows) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, {}, {}, object({{"spacing", 0.02}}));
    auto& emitter =
        static_cast<SquareEmitter&>(scene.graph().add(std::make_unique<SquareEmitter>(), "nozzle"));
    emitter.assignAll(object({{"width", 0.1}, {"height", 0.06}, {"speed", 1.0}}), {});
    scene.graph().link(SceneGraph::parseLink("nozzle.particles -> water.emitters"));
    scene.reset(1e-3);
    scene.frame();
    EXPECT_EQ(scene.positions().size(), 0u) << name;
    scene.step(95);  // 0.095 m of jet: layers 0 to 4 of 5 x 3 particles
    EXPECT_EQ(scene.positions().size(), 5u * 15u) << name;
    EXPECT_EQ(scene.fluid().particleCount(), 75) << name;
  }
}

TEST(ParticleFluid, CountsWhatLeavesTheDomain) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, {{0, 0, 0}, {0.5f, 0, 0}, {0.9f, 0, 0}}, {{0, 0, 0}, {0, 0, 0}, {20, 0, 0}},
                     object({{"spacing", 0.01},
                             {"domain_min", Value::Array{-1, -1, -1}},
                             {"domain_max", Value::Array{1, 1, 1}}}));
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step(10);
    NodeReport report = scene.report();
    EXPECT_EQ(report.statistics["particles"], Value(2)) << name;
    EXPECT_EQ(report.statistics["particles_escaped"], Value(1)) << name;
    // Those that stay keep their ids.
    const std::vector<Vec3f> positions = scene.positions();
    EXPECT_FLOAT_EQ(positions[0].x, 0.0f);
    EXPECT_FLOAT_EQ(positions[1].x, 0.5f);
  }
}

TEST(ParticleFluid, TwoScenesDoNotKnowOfEachOther) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> cubeA = jitteredCube(8, 0.01f, 0.2f, 1), cubeB = jitteredCube(9, 0.02f, 0.1f, 2);
    const auto alone = [&](const std::vector<Vec3f>& cube, float spacing) {
      FluidScene scene(*device, cube, {}, object({{"spacing", spacing}}));
      scene.reset(1e-3);
      scene.step(50);
      return scene.positions();
    };
    const std::vector<Vec3f> expectedA = alone(cubeA, 0.01f), expectedB = alone(cubeB, 0.02f);
    FluidScene a(*device, cubeA, {}, object({{"spacing", 0.01f}})),
        b(*device, cubeB, {}, object({{"spacing", 0.02f}}));
    a.reset(1e-3);
    b.reset(1e-3);
    for (int k = 0; k < 50; ++k) a.step(), b.step();
    EXPECT_EQ(a.positions(), expectedA) << name;
    EXPECT_EQ(b.positions(), expectedB) << name;
  }
}

TEST(ParticleFluid, AttributesOfModulesTravelWithTheirParticles) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, jitteredCube(6, 0.01f, 0.2f, 1), {}, object({{"spacing", 0.01f}}));
    scene.reset(1e-3);
    ParticleSet& particles = scene.fluid().fluid->set();
    const Attribute<float> tag =
        particles.add<float>({"tag", AttributeType::kFloat, "", "Ten times the id."});
    std::vector<float> tags;
    for (const std::int64_t id : particles.ids().toHost(particles.bound()))
      tags.push_back(10.0f * static_cast<float>(id));
    tag.assign(tags);
    scene.step(50);
    const std::vector<std::int64_t> ids = particles.ids().toHost(particles.bound());
    const std::vector<float> moved = particles.get<float>("tag").toHost(particles.bound());
    for (std::size_t k = 0; k < ids.size(); ++k) EXPECT_EQ(moved[k], 10.0f * static_cast<float>(ids[k]));
  }
}

TEST(ParticleFluid, NumbersThatAreNoneFailTheRun) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    FluidScene scene(*device, jitteredCube(6, 0.01f, 0.2f, 1), std::vector<Vec3f>(216, Vec3f{nan, 0, 0}),
                     object({}));
    try {
      scene.reset(1e-3);
      scene.step(2);
      scene.frame();
      FAIL() << "no error on " << name;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kSimulation);
      EXPECT_NE(std::string(e.what()).find("diverged"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("water"), std::string::npos) << e.what();
    }
  }
}

TEST(ParticleFluid, RefusesMuBesideBulkModulus) {
  ParticleFluid fluid;
  EXPECT_THROW(fluid.assignAll(object({{"mu", 1.0}, {"bulk_modulus", 1e6}}), {}), Error);
}

TEST(ParticleFluid, PipelineIsEditable) {
  const auto device = openDevice("cpu");
  const std::vector<Vec3f> cube = jitteredCube(6, 0.01f, 0.2f, 1);
  FluidScene still(
      *device, cube, {}, object({}),
      object({{"predict", object({{"enabled", false}})}, {"solver", object({{"enabled", false}})}}));
  still.reset(1e-3);
  still.step(5);
  EXPECT_EQ(still.positions(), cube);
}

}  // namespace
}  // namespace weir::test
