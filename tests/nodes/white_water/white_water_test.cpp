// White water: how much is made, against dt, frames and spacings; where it may go; and that the same bits
// come out. How it moves: white_water_motion_test.cpp.
#include "nodes/white_water/white_water.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "framework/communication/thread_ranks.h"
#include "nodes/rigid_body/rigid_body.h"
#include "tests/nodes/white_water/given_fluid.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"
#include "tests/support/resumed_scene.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

using WhiteWaterOn = OnDevice;

/// How many are made in a second of a fluid that always whirls.
double madeInASecond(Device& device, double dt, int inFrame) {
  Given scene(device);
  scene.fluid->positions = jitteredCube(8, 0.02f, 0.2f, 1);
  scene.fluid->velocities = whirl(scene.fluid->positions, 0.02f, 1.3f, {0, 0.5f, 0});
  scene.assign(object({{"trapped_air", 8e5}}));
  scene.reset(dt);
  scene.step(static_cast<int>(std::lround(0.5 / dt)), inFrame);
  return 2 * static_cast<double>(scene.report()["particles_made"].asInt());
}

TEST_P(WhiteWaterOn, WhatIsMadeInASecondDependsNeitherOnTheStepNorOnTheFrameRate) {
  const double usual = madeInASecond(*device, 0.005, 10);
  EXPECT_GT(usual, 5000);
  for (const auto& [dt, inFrame] : std::map<double, int>{{0.01, 2}, {0.002, 50}, {0.05, 1}})
    EXPECT_NEAR(madeInASecond(*device, dt, inFrame) / usual, 1, 0.05) << dt;
}

/// How many are made in a second where two sheets of water, 0.4 m wide, slide on each other.
double madeByASheet(Device& device, float spacing, const Value& parameters) {
  Given scene(device);
  scene.fluid->spacing = spacing;
  const int across = static_cast<int>(std::lround(0.4f / spacing));
  for (int x = 0; x < across; ++x)
    for (int z = 0; z < across; ++z)
      for (int y = -4; y < 4; ++y) {
        scene.fluid->positions.push_back(spacing * Vec3f{float(x), float(y), float(z)});
        scene.fluid->velocities.push_back({y < 0 ? -2.0f : 2.0f, 0, 0});
      }
  scene.assign(parameters);
  scene.reset(0.005);
  scene.step(60);
  return static_cast<double>(scene.report()["particles_made"].asInt()) / 0.3;
}

TEST_P(WhiteWaterOn, WhatIsMadePerAreaDoesNotDependOnTheSpacing) {
  const Value parameters = object({{"trapped_air", 2e5}, {"wave_crests", 0}});
  const double coarse = madeByASheet(*device, 0.04f, parameters),
               fine = madeByASheet(*device, 0.02f, parameters);
  EXPECT_GT(coarse, 3000);
  EXPECT_NEAR(fine / coarse, 1, 0.1);
}

/// How many are made in a second by the upper half of a round wave of 0.05 m that moves upwards, 0.2 m long.
double madeByACrest(Device& device, float spacing) {
  Given scene(device);
  scene.fluid->spacing = spacing;
  const int along = static_cast<int>(std::lround(0.2f / spacing));
  constexpr double kPi = 3.14159265358979;
  for (float r = 0.05f - 0.5f * spacing; r > 0; r -= spacing) {
    const int around = std::max(1, static_cast<int>(std::lround(2 * kPi * double(r) / double(spacing))));
    for (int k = 0; k < around; ++k)
      for (int z = 0; z < along; ++z) {
        const double angle = 2 * kPi * (k + 0.25) / around;
        scene.fluid->positions.push_back({r * static_cast<float>(std::cos(angle)),
                                          r * static_cast<float>(std::sin(angle)), spacing * float(z)});
        scene.fluid->velocities.push_back({0, 3, 0});
      }
  }
  scene.assign(object({{"trapped_air", 0}, {"wave_crests", 4e6}, {"crest_limits", Value::Array{2, 18}}}));
  scene.reset(0.005);
  scene.step(20);
  return static_cast<double>(scene.report()["particles_made"].asInt()) / 0.1;
}

TEST_P(WhiteWaterOn, WhatACrestMakesDependsLittleOnTheSpacing) {
  // A curvature of 10/m, on the side whose normal is within 53 degrees of the motion: half as much as can be.
  const double expected = 0.5 * 4e6 * 0.2 * 0.05 * 2 * std::acos(0.6);
  for (const float spacing : {0.01f, 0.005f})
    EXPECT_NEAR(madeByACrest(*device, spacing) / expected, 1, 0.3) << spacing;
}

TEST_P(WhiteWaterOn, FluidThatMovesAsOneMakesNothingBelowItsCrests) {
  Given scene(*device);
  scene.fluid->positions = jitteredCube(8, 0.02f, 0.1f, 1);
  scene.fluid->velocities.assign(scene.fluid->positions.size(), Vec3f{0, -5, 0});
  scene.assign(object({{"wave_crests", 0}}));
  scene.reset(0.005);
  scene.step(20);
  EXPECT_EQ(scene.report()["particles_made"], Value(0));
}

TEST_P(WhiteWaterOn, TheLimitIsKeptByMakingFewerEverywhere) {
  Given scene(*device);
  scene.fluid->positions = jitteredCube(8, 0.02f, 0, 1);
  scene.fluid->velocities = whirl(scene.fluid->positions, 0.02f, 3, {});
  scene.assign(object({{"trapped_air", 4e6}, {"max_particles", 300}}));
  scene.reset(0.005);
  scene.step(1);
  int left = 0, right = 0;
  for (const auto& [id, p] : scene.particles()) ++(p.position.x < 0.07f ? left : right);
  EXPECT_EQ(left + right, 300);
  EXPECT_GT(left, 100);
  EXPECT_GT(right, 100);
  scene.step(30);
  EXPECT_LE(scene.particles().size(), 300u);
  EXPECT_GT(scene.report()["particles_refused"].asInt(), 1000);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_CONTAINS(scene.warnings.front(), "max_particles");
  EXPECT_CONTAINS(scene.warnings.front(), "better: a larger max_particles");
}

TEST_P(WhiteWaterOn, FoamAndSprayDieInTheirTime) {
  Given scene(*device);
  scene.fluid->positions = jitteredCube(6, 0.02f, 0, 1);
  scene.fluid->velocities = whirl(scene.fluid->positions, 0.02f, 3, {});
  scene.fluid->onStep = [](GivenFluid& fluid, const StepContext& context) {
    if (context.index == 1) fluid.set().clear();
  };
  scene.assign(object(
      {{"trapped_air", 4e6}, {"lifetime", Value::Array{0.1, 0.3}}, {"radius", Value::Array{0.001, 0.002}}}));
  scene.reset(0.005);
  scene.step(1);
  for (const auto& [id, p] : scene.particles()) {
    EXPECT_TRUE(p.lifetime >= 0.1f && p.lifetime <= 0.3f) << p.lifetime;
    EXPECT_TRUE(p.radius >= 0.001f && p.radius <= 0.002f) << p.radius;
  }
  const double made = static_cast<double>(scene.particles().size());
  ASSERT_GT(made, 1000);
  scene.step(39);  // 0.195 s, in which 47.5 % die
  EXPECT_NEAR(static_cast<double>(scene.particles().size()) / made, 0.525, 0.04);
  scene.step(25);
  EXPECT_TRUE(scene.particles().empty());
}

/// Of the foam in the middle of that fluid, which has whirled and is at rest, the share that has 0.15 of 0.4
/// s behind it.
double foamLeft(Device& device, std::vector<Vec3f> positions, double filmLifetime) {
  constexpr float d = 0.02f;
  Given scene(device);
  scene.fluid->positions = std::move(positions);
  scene.fluid->velocities = whirl(scene.fluid->positions, d, 2, {});
  scene.fluid->onStep = [](GivenFluid& fluid, const StepContext& context) {
    if (context.index == 1) fluid.set().velocities().fillZero();
  };
  scene.assign(object({{"trapped_air", 8e6},
                       {"lifetime", Value::Array{0.4, 0.4}},
                       {"film_lifetime", filmLifetime},
                       {"rise_speed", 0.0}}));
  scene.reset(0.005);
  scene.step(1);
  const auto isInner = [](const Vec3f& p) {
    return std::min(p.x, p.y) > 3 * d && std::max(p.x, p.y) < 8 * d;
  };
  std::vector<std::int64_t> foam;
  for (const auto& [id, p] : scene.particles())
    if (p.kind == kFoam && isInner(p.position)) foam.push_back(id);
  EXPECT_GT(foam.size(), 50u);
  scene.step(30);
  const auto now = scene.particles();
  const auto left =
      std::count_if(foam.begin(), foam.end(), [&](std::int64_t id) { return now.contains(id); });
  return double(left) / double(foam.size());
}

TEST_P(WhiteWaterOn, FoamOnAFilmDiesSooner) {
  constexpr float d = 0.02f;
  const std::vector<Vec3f> deep = jitteredCube(12, d, 0.1f, 1);
  std::vector<Vec3f> film;  // stands upright, one particle thick
  for (const Vec3f& p : deep)
    if (p.z < 0.5f * d) film.push_back(p);
  EXPECT_GT(foamLeft(*device, deep, 0.25), 0.95);
  EXPECT_LT(foamLeft(*device, film, 0.25), 0.1);
  EXPECT_GT(foamLeft(*device, film, 1), 0.95);
}

TEST_P(WhiteWaterOn, OfParticlesThatRanksDoNotShareIsRefused) {
  Given scene(*device);
  runOnThreads(1, [&](Communicator& ranks) {
    const Error error = errorOf([&] { scene.foam->join(ranks); });
    EXPECT_CONTAINS(error.what(), "ranks do not share the particles of 'water.fluid'");
    EXPECT_CONTAINS(error.what(), "without --ranks");
  });
}

WEIR_ON_EVERY_DEVICE(WhiteWaterOn);

/// Water is thrown at a thin plate, in a box made of a mesh that moves.
constexpr const char* kThrown = R"({"weir": 1,
  "world": {"dt": 0.004, "frame_rate": 125, "duration": 0.6, "seed": 5},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [-0.3, -0.15, -0.12], "max": [-0.1, 0.15, 0.12], "velocity": [6, 3, 0]}},
    "plate": {"type": "StaticBoundary", "params": {"shape": "box", "min": [0.2, -0.4, -0.5], "max": [0.203, 0.2, 0.5]}},
    "room": {"type": "BoxMesh", "params": {"min": [-0.5, -0.4, -0.3], "max": [0.5, 0.5, 0.3]}},
    "walls": {"type": "SemiAnalyticalSFI", "params": {"fill": "container", "velocity": [0.5, 0, 0]}},
    "drain": {"type": "Sink", "params": {"min": [0.3, -0.4, -0.3], "max": [0.9, -0.3, 0.3]}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.04, "rest_steps": 0},
              "modules": {"solver": {"type": "SemiImplicitSolver"}}},
    "foam": {"type": "WhiteWater", "params": {"trapped_air": 1e6, "air_limits": [0.05, 0.5]}}},
  "links": ["block.particles -> water.initial", "plate.boundary -> water.boundaries", "room.surface -> walls.solids",
            "water.fluid -> walls.fluid", "drain.sink -> water.sinks", "water.fluid -> foam.fluid"]})";

TEST_P(WhiteWaterOn, NonePassesAWall) {
  SimulatedScene scene(*device, kThrown);
  scene->reset();
  ParticleSet* set = &scene.node<WhiteWater>("foam").particles->set();
  std::map<std::int64_t, Vec3f> before;
  std::int64_t seen = 0;
  const std::atomic<bool> stop{false};
  for (int frame = 0; frame < 75; ++frame) {
    scene->advanceFrame(stop);
    const std::int64_t n = set->refreshCount();
    const auto x = set->positions().toHost(n);
    const auto ids = set->ids().toHost(n);
    const float moved = 0.5f * static_cast<float>(scene->time());
    std::map<std::int64_t, Vec3f> now;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Vec3f p = x[k];
      EXPECT_TRUE(p.x > -0.5f + moved && p.x < 0.5f + moved && std::abs(p.z) < 0.3f && p.y > -0.4f &&
                  p.y < 0.5f)
          << p.x << " " << p.y << " " << p.z << " at " << scene->time();
      EXPECT_FALSE(p.x > 0.2f && p.x < 0.203f && p.y < 0.2f) << "within the plate";
      // What is below the plate's upper edge on both sides has not gone over it in one step.
      const auto at = before.find(ids[k]);
      if (at != before.end() && p.y < 0.15f && at->second.y < 0.15f) {
        EXPECT_EQ(p.x > 0.2f, at->second.x > 0.2f) << "through the plate";
      }
      now[ids[k]] = p;
    }
    seen += n;
    before = std::move(now);
  }
  EXPECT_GT(seen, 10000);
  NodeReport report;
  scene.node<WhiteWater>("foam").report(report);
  EXPECT_GT(report.statistics["particles_removed"].asInt(), 0);
}

TEST_P(WhiteWaterOn, NoneIsInABodyThatForcesMove) {
  SimulatedScene scene(*device, R"({"weir": 1,
    "world": {"dt": 0.003, "frame_rate": 100, "duration": 0.4, "seed": 5},
    "nodes": {
      "pool": {"type": "BoxSampler", "params": {"min": [-0.25, 0, -0.15], "max": [0.25, 0.15, 0.15]}},
      "tank": {"type": "StaticBoundary",
               "params": {"shape": "box", "min": [-0.25, 0, -0.15], "max": [0.25, 0.9, 0.15], "inverted": true}},
      "box": {"type": "BoxMesh", "params": {"min": [-0.08, 0.2, -0.08], "max": [0.08, 0.3, 0.08]}},
      "body": {"type": "RigidBody", "params": {"density": 600, "velocity": [0.5, -4, 0], "fixed_rotation": "xyz"}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.03, "rest_steps": 0},
                "modules": {"solver": {"type": "SemiImplicitSolver"}}},
      "foam": {"type": "WhiteWater", "params": {"trapped_air": 3e6, "air_limits": [0.02, 0.3]}}},
    "links": ["pool.particles -> water.initial", "tank.boundary -> water.boundaries", "box.surface -> body.mesh",
              "tank.boundary -> body.walls", "water.fluid -> body.fluid", "water.fluid -> foam.fluid"]})");
  scene->reset();
  ParticleSet& set = scene.node<WhiteWater>("foam").particles->set();
  const std::atomic<bool> stop{false};
  std::int64_t near = 0;
  for (int frame = 0; frame < 40; ++frame) {
    scene->advanceFrame(stop);
    NodeReport report;
    scene.node<RigidBody>("body").report(report);
    const Value::Array center = report.statistics["position"].asArray();
    const Vec3f half{0.08f, 0.05f, 0.08f};
    for (const Vec3f& p : set.positions().toHost(set.refreshCount())) {
      float out = -1;  // of the box, along its axes
      for (int c = 0; c < 3; ++c)
        out = std::max(out, std::abs(p[c] - static_cast<float>(center[std::size_t(c)].asDouble())) - half[c]);
      EXPECT_GT(out, 0) << "in the body at " << scene->time();
      near += out < 0.03f;
    }
  }
  EXPECT_GT(near, 2000);
}

std::map<std::string, std::vector<std::byte>> stateOf(const Simulation& simulation) {
  StateArrays arrays;
  simulation.scene().graph.save(StateWriter(arrays));
  std::map<std::string, std::vector<std::byte>> bytes;
  for (const auto& [name, array] : arrays)
    if (name.find("foam") != std::string::npos) bytes[name] = array.data;
  return bytes;
}

TEST(WhiteWater, HasTheSameBitsWithOneThreadAndFour) {
  std::map<std::string, std::vector<std::byte>> found[2];
  for (const int k : {0, 1}) {
    const auto device = openDevice("cpu", k == 0 ? 1 : 4);
    SimulatedScene scene(*device, kThrown);
    scene->reset();
    const std::atomic<bool> stop{false};
    for (int frame = 0; frame < 30; ++frame) scene->advanceFrame(stop);
    EXPECT_GT(scene.node<WhiteWater>("foam").particleCount(), 100);
    found[k] = stateOf(*scene);
  }
  EXPECT_TRUE(found[0] == found[1]);
}

TEST(WhiteWater, GoesOnBitByBitWhenItIsResumed) {
  std::int64_t made = 0;
  ResumeCheck check{.savedAt = 25, .comparedFor = 5};
  check.observe = [&](Simulation& simulation, const StateWriter&) {
    made = std::max(made, dynamic_cast<WhiteWater&>(*simulation.scene().graph.find("foam")).particleCount());
  };
  EXPECT_EQ(resumedSceneDifferences(kThrown, check), std::vector<std::string>{});
  EXPECT_GT(made, 100);
}

TEST(WhiteWater, SaysWhatIsWrongWithItsParameters) {
  const auto device = openDevice("cpu");
  const auto tried = [&](const char* name, Value value) {
    return errorOf([&] {
      Given scene(*device);
      Value parameters = Value::object();
      parameters[name] = std::move(value);
      scene.assign(parameters);
      scene.foam->validate();
    });
  };
  const Error swapped = tried("speed_limits", Value::Array{3, 1});
  EXPECT_CONTAINS(swapped.what(), "the first number, 3, is above the second, 1");
  EXPECT_CONTAINS(swapped.what(), "speed_limits");
  EXPECT_CONTAINS(tried("air_limits", Value::Array{1, 1}).what(), "is the same as the second");
  EXPECT_CONTAINS(tried("lifetime", Value::Array{2, 1}).what(), "the first no larger than the second");
  EXPECT_CONTAINS(tried("radius", Value::Array{0, 1}).what(), "radius");
  EXPECT_CONTAINS(tried("trapped_air", -1).what(), "trapped_air");
}

TEST(WhiteWater, RefusesParticlesThatAreNoMatter) {
  const auto device = openDevice("cpu");
  Given scene(*device);
  scene.fluid->spacing = 0;
  const Error error = errorOf([&] { scene.reset(0.01); });
  EXPECT_CONTAINS(error.what(), "'water.fluid' have no volume");
}

}  // namespace
}  // namespace weir::test
