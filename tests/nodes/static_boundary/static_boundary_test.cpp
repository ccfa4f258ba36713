// What walls do to particles, against the laws of mechanics; and what the node accepts.
#include "nodes/static_boundary/static_boundary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "nodes/particle_fluid/particle_fluid.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.02f;
constexpr double kDt = 0.001;

/// How near to a wall a particle of FluidScene's fluid comes that no pressure holds.
double contact() {
  return kContactRatio * kSpacing;
}

Value vector(double x, double y, double z) {
  return Value::Array{x, y, z};
}

void setAll(Node& node, const Value& parameters) {
  node.assignAll(parameters, {"test", "", ""});
}

StaticBoundary& addBoundary(FluidScene& scene, const Value& parameters, const std::string& name = "wall") {
  auto& node = static_cast<StaticBoundary&>(scene.graph().add(std::make_unique<StaticBoundary>(), name));
  setAll(node, parameters);
  scene.graph().link({name, "boundary", scene.fluid().name(), "boundaries"});
  return node;
}

class Walls : public OnDevice {
 protected:
  /// One particle that nothing but gravity and walls acts on.
  FluidScene oneParticle(Vec3f position, Vec3f velocity) const {
    return FluidScene(*device, {position}, {velocity}, object({{"spacing", kSpacing}}));
  }
};

TEST_P(Walls, AParticleComesToRestAtContactAboveTheFloor) {
  FluidScene scene = oneParticle({0, 0.1f, 0}, {});
  addBoundary(scene, object({{"shape", "plane"}}));
  scene.reset(kDt);
  scene.step(500);
  EXPECT_NEAR(scene.positions()[0].y, contact(), 1e-6);
  EXPECT_NEAR(scene.velocities()[0].y, 0, 1e-6);
}

TEST_P(Walls, ABounceKeepsTheShareOfSpeedThatRestitutionSays) {
  for (const double restitution : {0.0, 0.3, 1.0}) {
    FluidScene scene = oneParticle({0, 0.05f, 0}, {1, -2, 0});
    scene.gravity = {};
    addBoundary(scene, object({{"shape", "plane"}, {"restitution", restitution}}));
    scene.reset(kDt);
    scene.step(40);
    EXPECT_NEAR(scene.velocities()[0].y, 2 * restitution, 1e-5);
    EXPECT_NEAR(scene.velocities()[0].x, 1, 1e-5) << "a wall without friction leaves the rest as it is";
  }
}

TEST_P(Walls, FrictionOnAnInclineIsCoulombs) {
  constexpr double kGravity = 9.8, kTime = 0.5;
  const double angle = 30 * std::numbers::pi / 180;
  const Value normal = vector(std::sin(angle), std::cos(angle), 0);
  for (const double friction : {0.0, 0.2, 0.5, 0.7}) {
    const auto radius = static_cast<float>(kSpacing / 2);
    FluidScene scene = oneParticle({radius * float(std::sin(angle)), radius * float(std::cos(angle)), 0}, {});
    addBoundary(scene, object({{"shape", "plane"}, {"normal", normal}, {"friction", friction}}));
    scene.reset(kDt);
    scene.step(static_cast<int>(kTime / kDt));
    const double acceleration = std::max(0.0, kGravity * (std::sin(angle) - friction * std::cos(angle)));
    const Vec3f v = scene.velocities()[0];
    EXPECT_NEAR(length(v), acceleration * kTime, 2e-3) << "friction " << friction;
    EXPECT_NEAR(std::hypot(v.x, v.y), length(v), 1e-6);
  }
}

TEST_P(Walls, AParticleShotIntoACornerStaysOutsideOfAllThreeWalls) {
  FluidScene scene = oneParticle({0.03f, 0.03f, 0.03f}, {-3, -3, -3});
  addBoundary(
      scene,
      object({{"shape", "box"}, {"min", vector(0, 0, 0)}, {"max", vector(1, 1, 1)}, {"inverted", true}}));
  scene.reset(kDt);
  double nearest = 1;
  for (int step = 0; step < 100; ++step) {
    scene.step();
    const Vec3f p = scene.positions()[0];
    for (int axis = 0; axis < 3; ++axis) nearest = std::min(nearest, double(p[axis]));
    EXPECT_LT(length(scene.velocities()[0]), 3 * std::sqrt(3.0) + 9.8 * kDt * 100) << "step " << step;
  }
  EXPECT_GT(nearest, contact() - 1e-6);
  EXPECT_LT(nearest, kSpacing / 2);
}

TEST_P(Walls, TwoBoundariesInOneActLikeTwo) {
  const Value toTheRight = object({{"shape", "plane"}, {"normal", vector(1, 0, 0)}});
  const auto rest = [&](bool together) {
    FluidScene scene = oneParticle({0.05f, 0.05f, 0}, {-1, 0, 0});
    if (together) {
      setAll(scene.graph().add(std::make_unique<StaticBoundary>(), "left"), toTheRight);
      addBoundary(scene, object({{"shape", "plane"}}), "floor");
      scene.graph().link({"left", "boundary", "floor", "boundaries"});
    } else {
      addBoundary(scene, object({{"shape", "plane"}}), "floor");
      addBoundary(scene, toTheRight, "left");
    }
    scene.reset(kDt);
    scene.step(300);
    return scene.positions()[0];
  };
  const Vec3f one = rest(true), two = rest(false);
  EXPECT_LT(length(one - two), 1e-6);
  for (const float distance : {one.x, one.y}) EXPECT_GT(distance, contact() - 1e-6);
  EXPECT_LT(one.y, kSpacing / 2);
}

TEST_P(Walls, AFullTankKeepsAllItsParticles) {
  const auto particles = jitteredCube(10, kSpacing, 0.1f, 3, {0.01f, 0.01f, 0.01f});
  FluidScene scene(*device, particles, std::vector<Vec3f>(particles.size()), object({{"spacing", kSpacing}}));
  const float side = 0.25f;
  addBoundary(
      scene,
      object(
          {{"shape", "box"}, {"min", vector(0, 0, 0)}, {"max", vector(side, 1, side)}, {"inverted", true}}));
  scene.reset(kDt);
  scene.step(500);
  const auto positions = scene.positions();
  ASSERT_EQ(positions.size(), particles.size());
  const auto nearest = 0.999f * static_cast<float>(contact());
  for (const Vec3f& p : positions) {
    EXPECT_GT(p.y, nearest);
    for (const float x : {p.x, p.z}) {
      EXPECT_GT(x, nearest);
      EXPECT_LT(x, side - nearest);
    }
  }
}

WEIR_ON_EVERY_DEVICE(Walls);

/// Positions and velocities after three steps of particles too far apart to meet, on both sides of the walls
/// of a box, at its faces, edges and corners.
std::vector<Vec3f> motionAtABox(CpuIsa isa, bool inverted, const Value& modules) {
  CpuDevice device(2, isa);
  std::mt19937 random(17);
  std::uniform_real_distribution<float> jitter(-0.02f, 0.02f), speed(-3, 3);
  std::vector<Vec3f> positions, velocities;
  for (int k = 0; k < 11 * 11 * 11; ++k) {
    const Vec3f at{float(k % 11), float(k / 11 % 11), float(k / 121)};
    positions.push_back(0.1f * at + Vec3f{jitter(random), jitter(random), jitter(random)});
    velocities.push_back({speed(random), speed(random), speed(random)});
  }
  FluidScene scene(device, positions, velocities, object({{"spacing", kSpacing}}), modules);
  addBoundary(scene, object({{"shape", "box"},
                             {"min", vector(0.2, 0.1, 0.2)},
                             {"max", vector(0.9, 0.8, 0.7)},
                             {"rotation", vector(10, 20, 5)},
                             {"restitution", 0.4},
                             {"friction", 0.3},
                             {"inverted", inverted}}));
  scene.reset(kDt);
  scene.step(3);
  std::vector<Vec3f> motion = scene.positions();
  const std::vector<Vec3f> after = scene.velocities();
  motion.insert(motion.end(), after.begin(), after.end());
  return motion;
}

TEST(StaticBoundaryNode, ABoxActsBitwiseTheSameForAllInstructionsOfTheCpu) {
  // With a tolerance, walls hold particles in every iteration.
  const Value tolerance =
      object({{"solver", object({{"type", "AcceleratedSolver"},
                                 {"params", object({{"max_iterations", 5}, {"acceleration", "none"}})}})}});
  for (const Value& modules : {Value::object(), tolerance})
    for (const bool inverted : {false, true}) {
      const std::vector<Vec3f> expected = motionAtABox(CpuIsa::kBaseline, inverted, modules);
      for (const CpuIsa isa : usableCpuIsas())
        EXPECT_EQ(motionAtABox(isa, inverted, modules), expected)
            << cpuIsaName(isa) << ", inverted " << inverted;
    }
}

TEST(StaticBoundaryNode, RefusesWhatMeansNothing) {
  StaticBoundary node;
  const auto messageFor = [&](const Value& parameters) {
    return std::string(errorOf([&] { setAll(node, parameters); }).what());
  };
  EXPECT_CONTAINS(messageFor(object({{"shape", "sphere"}, {"min", vector(0, 0, 0)}})), "'min'");
  EXPECT_CONTAINS(messageFor(object({{"shape", "box"}, {"radius", 1.0}})), "sphere, cylinder, capsule, cone");
  EXPECT_CONTAINS(messageFor(object({{"shape", "box"}, {"min", vector(0, 0, 0)}, {"max", vector(1, 0, 1)}})),
                  "no volume");
  EXPECT_CONTAINS(messageFor(object({{"shape", "plane"}, {"normal", vector(0, 0, 0)}})), "[0, 0, 0]");
  EXPECT_CONTAINS(messageFor(object({{"shape", "cube"}})), "box");
  EXPECT_CONTAINS(messageFor(object({{"shape", "plane"}, {"friction", -1.0}})), "friction");
}

TEST(StaticBoundaryNode, AnEmptyBoundaryIsAnError) {
  const auto device = openDevice("cpu");
  FluidScene scene(*device, {{0, 0, 0}}, {{0, 0, 0}}, object({{"spacing", kSpacing}}));
  addBoundary(scene, Value::object());
  const Error e = errorOf([&] { scene.reset(kDt); });
  EXPECT_CONTAINS(e.what(), "wall");
  EXPECT_CONTAINS(e.what(), "empty");
}

}  // namespace
}  // namespace weir::test
