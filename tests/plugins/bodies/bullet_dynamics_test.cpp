// Contacts and joints of bodies without a fluid, against closed forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>

#include "nodes/body_contacts/body_contacts.h"
#include "nodes/rigid_body/rigid_body.h"
#include "tests/plugins/bodies/bullet_registry.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/resumed_scene.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr double kGravity = 10, kDt = 0.002;

/// Boxes with BodyContacts, above a floor if it is given.
struct Boxes {
  double gravity = kGravity, dt = kDt;
  std::string floor = R"("shape": "plane")";
  std::string nodes, links;
  int count = 0;

  /// Of those half sides.
  void add(const Vec3d& half, const std::string& params) {
    nodes += fmt::format(
        R"("mesh{0}": {{"type": "BoxMesh", "params": {{"min": [{1}, {2}, {3}], "max": [{4}, {5}, {6}]}}}},
           "b{0}": {{"type": "RigidBody", "params": {{{7}}}}}, )",
        count, -half.x, -half.y, -half.z, half.x, half.y, half.z, params);
    links += fmt::format(R"("mesh{0}.surface -> b{0}.mesh", "b{0}.body -> contacts.bodies", )", count);
    if (!floor.empty()) links += fmt::format(R"("floor.boundary -> b{}.walls", )", count);
    ++count;
  }
  void join(const std::string& params, const std::string& other = "") {
    nodes += fmt::format(R"("joint": {{"type": "Joint", "params": {{{}}}}}, )", params);
    links += R"("b0.body -> joint.body", "joint.joint -> contacts.joints", )";
    if (!other.empty()) links += fmt::format(R"("{}.body -> joint.other", )", other);
  }
  std::string text() const {
    const std::string ground =
        floor.empty() ? ""
                      : fmt::format(R"("floor": {{"type": "StaticBoundary", "params": {{{}}}}}, )", floor);
    std::string all = links.substr(0, links.rfind(','));
    return fmt::format(
        R"({{"weir": 1, "world": {{"gravity": [0, {}, 0], "dt": {}, "frame_rate": 20, "duration": 20}},
                          "nodes": {{{}{}"contacts": {{"type": "BodyContacts"}}}}, "links": [{}]}})",
        -gravity, dt, ground, nodes, all);
  }
};

struct Trial {
  explicit Trial(const Boxes& boxes, int threads = 1, const std::string& device = "cpu")
      : device_(openDevice(device, threads)), scene(*device_, boxes.text(), {}, addBullet) {
    scene->reset();
  }
  BodyState state(int k = 0) { return body(k).state(); }
  const RigidBody& body(int k = 0) { return scene.node<RigidBody>(fmt::format("b{}", k).c_str()); }
  Twist motion(int k = 0) { return twistOf(body(k).massOf(), state(k)); }
  void advance(int frames) {
    const std::atomic<bool> stop = false;
    for (int k = 0; k < frames; ++k) scene->advanceFrame(stop);
  }

 private:
  std::unique_ptr<Device> device_;

 public:
  SimulatedScene scene;
};

Boxes stack(int count) {
  Boxes boxes;
  for (int k = 0; k < count; ++k)
    boxes.add({0.05, 0.05, 0.05}, fmt::format(R"("density": 500, "wall_friction": 0.5, "restitution": 0,
                                                "position": [{}, {}, 0])",
                                              k % 2 == 0 ? 0.005 : -0.005, 0.0501 + 0.1001 * k));
  return boxes;
}

TEST(BulletDynamics, AStackOfBoxesStands) {
  constexpr int kCount = 10;
  Trial run(stack(kCount));
  run.advance(200);
  double fastest = 0, off = 0, deepest = 0;
  for (int k = 0; k < kCount; ++k) {
    fastest = std::max(fastest, length(run.state(k).velocity));
    off = std::max(off, std::abs(run.state(k).center.x - (k % 2 == 0 ? 0.005 : -0.005)));
    deepest = std::max(deepest, std::abs(run.state(k).center.y - (0.05 + 0.1 * k)));
  }
  std::printf("stack after 10 s: %.2g m/s, %.2g m aside, %.2g m off its height\n", fastest, off, deepest);
  EXPECT_LT(fastest, 3e-4);
  EXPECT_LT(off, 5e-4);
  EXPECT_LT(deepest, 1e-4);
}

/// How far a box slides in a second on a slope of that tangent, m; gravity stands upright to it.
double slideOn(double tangent, double friction, bool onBox) {
  const double angle = std::atan(tangent) * 180 / std::numbers::pi;
  Boxes boxes;
  boxes.floor = fmt::format(R"("shape": "plane", "normal": [{}, {}, 0])", std::sin(std::atan(tangent)),
                            std::cos(std::atan(tangent)));
  const auto above = [&](double height) {
    return fmt::format("[{}, {}, 0]", height * std::sin(std::atan(tangent)),
                       height * std::cos(std::atan(tangent)));
  };
  if (onBox)
    boxes.add({0.5, 0.05, 0.5},
              fmt::format(R"("density": 1000, "restitution": 0, "wall_friction": {}, "fixed": "xyz",
        "fixed_rotation": "xyz", "rotation": [0, 0, {}], "position": {})",
                          friction, -angle, above(0.05)));
  boxes.add({0.1, 0.03, 0.1}, fmt::format(R"("density": 500, "restitution": 0, "wall_friction": {},
        "rotation": [0, 0, {}], "position": {})",
                                          friction, -angle, above(onBox ? 0.13 : 0.03)));
  Trial run(boxes);
  const int k = onBox ? 1 : 0;
  const Vec3d from = run.state(k).center;
  run.advance(20);
  return length(run.state(k).center - from);
}

/// Sliding from rest, ½·g·(sin α − μ·cos α) in a second.
TEST(BulletDynamics, SlidingBeginsAtTheFrictionsAngle) {
  for (const bool onBox : {false, true})
    for (const double friction : {0.2, 0.5}) {
      const double below = slideOn(0.99 * friction, friction, onBox);
      const double tangent = 1.2 * friction, angle = std::atan(tangent);
      const double above = slideOn(tangent, friction, onBox),
                   atOnce = slideOn(1.01 * friction, friction, onBox);
      const auto expected = [&](double of) {
        return 0.5 * kGravity * (std::sin(std::atan(of)) - friction * std::cos(std::atan(of)));
      };
      std::printf("mu %g: %.2g m below, %.4f of %.4f m just above, %.4f of %.4f m above\n", friction, below,
                  atOnce, expected(1.01 * friction), above, expected(tangent));
      EXPECT_LT(below, 1e-6);
      EXPECT_NEAR(atOnce, expected(1.01 * friction), 2e-4);
      EXPECT_NEAR(above / expected(tangent), 1, 0.03) << angle;
    }
}

TEST(BulletDynamics, ACollisionKeepsMomentumAndRestitution) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    Boxes boxes{.gravity = 0, .floor = ""};
    const std::string material = fmt::format(R"("restitution": {}, "wall_friction": 0.3)", restitution);
    boxes.add({0.05, 0.05, 0.05},
              R"("mass": 2, "velocity": [1.5, 0, 0], "position": [-0.2, 0, 0], )" + material);
    boxes.add({0.05, 0.05, 0.05},
              R"("mass": 3, "velocity": [-0.5, 0, 0], "position": [0.2, 0, 0], )" + material);
    Trial run(boxes);
    run.advance(10);
    const Vec3d one = run.state(0).velocity, two = run.state(1).velocity;
    EXPECT_NEAR(2 * one.x + 3 * two.x, 1.5, 1e-9) << restitution;
    EXPECT_NEAR(two.x - one.x, 2 * restitution, 0.02) << restitution;
  }
}

/// Off centre, turned: momentum and angular momentum are kept, with friction.
TEST(BulletDynamics, ASkewCollisionKeepsAngularMomentum) {
  Boxes boxes{.gravity = 0, .floor = ""};
  boxes.add({0.05, 0.08, 0.04}, R"("mass": 2, "velocity": [1.5, 0.2, 0], "position": [-0.2, 0.03, 0.02],
      "rotation": [10, 20, 30], "wall_friction": 0.4)");
  boxes.add({0.03, 0.05, 0.05}, R"("mass": 3, "velocity": [-0.5, 0, 0], "angular_velocity": [1, 2, 3],
      "position": [0.2, 0, 0], "wall_friction": 0.4)");
  Trial run(boxes);
  const auto momentum = [&] {
    SolidImpulse sum;
    for (int k = 0; k < 2; ++k) {
      const Vec3d p = run.body(k).massOf().mass * run.state(k).velocity;
      sum += {p, cross(run.state(k).center, p) + run.state(k).spin};
    }
    return sum;
  };
  const SolidImpulse before = momentum();
  const Vec3d velocity = run.state(0).velocity;
  run.advance(10);
  EXPECT_GT(length(run.state(0).velocity - velocity), 0.5);
  EXPECT_NEAR(length(momentum().linear - before.linear), 0, 1e-9);
  EXPECT_NEAR(length(momentum().angular - before.angular), 0, 2e-3);
}

TEST(BulletDynamics, ABallOfGroundBouncesToTheSquareOfItsRestitution) {
  Boxes boxes;
  boxes.add({0.05, 0.05, 0.05}, R"("density": 500, "restitution": 0.8, "position": [0, 0.55, 0])");
  Trial run(boxes);
  double highest = 0;
  bool hit = false;
  const std::atomic<bool> stop = false;
  double last = 0;
  for (int frame = 0; frame < 14; ++frame)
    run.scene->advanceFrame(stop, [&] {
      const BodyState now = run.state();
      hit = hit || now.velocity.y > 1;
      if (hit && last >= 0) highest = std::max(highest, now.center.y - 0.05);
      if (hit && now.velocity.y < 0) last = -1;
    });
  std::printf("bounced to %.4f m of %.4f m\n", highest, 0.64 * 0.5);
  EXPECT_NEAR(highest, 0.64 * 0.5, 0.03 * 0.5);
}

/// T = 2π·√(I/(m·g·l)) at small angles, I about the hinge.
TEST(BulletDynamics, APendulumHasItsPeriod) {
  Boxes boxes{.floor = ""};
  boxes.add({0.02, 0.1, 0.03}, R"("density": 500, "position": [0.03, -0.5, 0])");
  boxes.join(R"("kind": "hinge", "anchor": [0, 0, 0], "axis": [0, 0, 1])");
  Trial run(boxes);
  std::vector<double> crossings;
  double last = 0.03, time = 0;
  const std::atomic<bool> stop = false;
  for (int frame = 0; frame < 160; ++frame)
    run.scene->advanceFrame(stop, [&] {
      time += kDt;
      const double x = run.state().center.x;
      if (last > 0 && x <= 0) crossings.push_back(time - kDt * x / (x - last));
      last = x;
    });
  ASSERT_GE(crossings.size(), 4u);
  const double l = std::hypot(0.03, 0.5);
  const double amplitude = std::atan2(0.03, 0.5), inertia = (0.04 * 0.04 + 0.2 * 0.2) / 12 + l * l;
  const double expected =
      2 * std::numbers::pi * std::sqrt(inertia / (kGravity * l)) * (1 + amplitude * amplitude / 16);
  const double period = (crossings.back() - crossings.front()) / double(crossings.size() - 1);
  std::printf("period %.5f of %.5f s\n", period, expected);
  EXPECT_NEAR(period / expected, 1, 0.005);
  EXPECT_NEAR(length(run.state().center), l, 1e-4);
}

TEST(BulletDynamics, AMotorTurnsAHinge) {
  Boxes boxes{.floor = ""};
  boxes.add({0.1, 0.02, 0.1}, R"("density": 500)");
  boxes.join(R"("axis": [0, 1, 0], "motor": true, "speed": 3, "max_effort": 5)");
  Trial run(boxes);
  run.advance(10);
  EXPECT_NEAR(run.motion().angular.y, 3, 1e-3);
  EXPECT_NEAR(length(run.state().center), 0, 1e-4);
}

/// Angular acceleration torque/inertia.
TEST(BulletDynamics, AnEffortTurnsAHinge) {
  Boxes boxes{.floor = ""};
  boxes.add({0.1, 0.02, 0.1}, R"("mass": 3)");
  boxes.join(R"("axis": [0, 1, 0], "effort": 0.1)");
  Trial run(boxes);
  run.advance(10);
  EXPECT_NEAR(run.motion().angular.y, 0.5 * 0.1 / (3 * (0.2 * 0.2 + 0.2 * 0.2) / 12), 1e-3);
}

TEST(BulletDynamics, ASliderFallsAlongItsAxisAlone) {
  Boxes boxes{.floor = ""};
  boxes.add({0.1, 0.02, 0.1}, R"("mass": 3)");
  boxes.join(R"("kind": "slider", "axis": [1, -1, 0])");
  Trial run(boxes);
  run.advance(10);
  const double way = 0.5 * kGravity * std::sqrt(0.5) * 0.25;
  const BodyState now = run.state();
  EXPECT_NEAR(now.center.x, way * std::sqrt(0.5), 0.01 * way);
  EXPECT_NEAR(now.center.y, -now.center.x, 1e-3);
  EXPECT_NEAR(length(run.motion().angular), 0, 1e-6);
}

TEST(BulletDynamics, AFixedJointHoldsTwoBodiesTogether) {
  Boxes boxes{.gravity = 0, .floor = ""};
  boxes.add({0.05, 0.05, 0.05}, R"("mass": 1, "position": [-0.06, 0, 0], "velocity": [0, 1, 0])");
  boxes.add({0.05, 0.05, 0.05}, R"("mass": 1, "position": [0.06, 0, 0], "velocity": [0, -1, 0])");
  boxes.join(R"("kind": "fixed")", "b1");
  Trial run(boxes);
  run.advance(20);
  EXPECT_NEAR(length(run.state(0).center - run.state(1).center), 0.12, 1e-3);
  EXPECT_NEAR(length(run.motion(0).angular - run.motion(1).angular), 0, 1e-3);
  EXPECT_LT(run.motion(0).angular.z, -5);
}

/// 2π·√(m/k).
TEST(BulletDynamics, ASpringHasItsPeriod) {
  Boxes boxes{.gravity = 0, .floor = ""};
  boxes.add({0.05, 0.05, 0.05}, R"("mass": 2, "position": [0.25, 0, 0])");
  boxes.join(
      R"("kind": "spring", "anchor": [0.25, 0, 0], "other_anchor": [0, 0, 0], "length": 0.2, "stiffness": 50)");
  Trial run(boxes);
  const double period = 2 * std::numbers::pi * std::sqrt(2.0 / 50);
  double last = 0.05, time = 0;
  std::vector<double> crossings;
  const std::atomic<bool> stop = false;
  for (int frame = 0; frame < 60; ++frame)
    run.scene->advanceFrame(stop, [&] {
      time += kDt;
      const double x = run.state().center.x - 0.2;
      if (last > 0 && x <= 0) crossings.push_back(time - kDt * x / (x - last));
      last = x;
    });
  ASSERT_GE(crossings.size(), 2u);
  EXPECT_NEAR((crossings.back() - crossings.front()) / double(crossings.size() - 1), period, 0.005 * period);
}

/// A block, and two beside each other, which are not convex together.
TEST(BulletDynamics, MeshesThatDoNotMoveHoldBodies) {
  for (const bool convex : {true, false}) {
    Boxes boxes{.floor = ""};
    boxes.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0, 0.1, 0], "restitution": 0)");
    boxes.nodes +=
        convex ? R"("ground": {"type": "BoxMesh", "params": {"min": [-1, -0.3, -1], "max": [1, 0, 1]}}, )"
               : R"("ground": {"type": "TurningModel", "params": {"segments": 16, "position": [0.1, 0, 0],
                            "profile": [[0, -0.3], [1, -0.3], [1, 0.2], [0.8, 0.2], [0.8, 0], [0, 0]]}}, )";
    boxes.links += R"("ground.surface -> contacts.solids", )";
    Trial run(boxes);
    run.advance(40);
    std::printf("at rest on a mesh: %.2g m/s, %.2g m off\n", length(run.state().velocity),
                run.state().center.y - 0.05);
    EXPECT_NEAR(run.state().center.y, 0.05, 5e-4);
    EXPECT_LT(length(run.state().velocity), convex ? 1e-3 : 1e-2);
  }
}

/// A few particles far away, as what moves solids needs a fluid.
void addFarFluid(Boxes& boxes) {
  boxes.nodes +=
      R"("drop": {"type": "BoxSampler", "params": {"min": [50, 50, 50], "max": [50.2, 50.2, 50.2]}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.1, "rest_steps": 0}}, )";
  boxes.links += R"("drop.particles -> water.initial", "water.fluid -> moved.fluid", )";
}

TEST(BulletDynamics, AMovingSolidPushesABodyAtItsSpeed) {
  Boxes boxes;
  boxes.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0.2, 0.05, 0], "restitution": 0)");
  addFarFluid(boxes);
  boxes.nodes +=
      R"("pusher": {"type": "BoxMesh", "params": {"min": [-0.1, 0.01, -0.2], "max": [0, 0.2, 0.2]}},
      "moved": {"type": "SemiAnalyticalSFI", "params": {"velocity": [0.5, 0, 0]}}, )";
  boxes.links += R"("pusher.surface -> moved.solids", "pusher.surface -> contacts.solids", )";
  Trial run(boxes);
  run.advance(20);
  const BodyState state = run.state();
  std::printf("pushed to %.5f m, at %.5f m/s\n", state.center.x, state.velocity.x);
  EXPECT_NEAR(state.center.x, 0.5 + 0.05, 1e-3);
  EXPECT_NEAR(state.velocity.x, 0.5, 0.01);
}

/// Friction carries it along on a circle, as ω²·r < μ·g.
TEST(BulletDynamics, ATurntableCarriesABody) {
  Boxes boxes{.floor = ""};
  boxes.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0.3, 0.05, 0], "wall_friction": 0.5,
                                    "velocity": [0, 0, -0.3], "angular_velocity": [0, 1, 0])");
  addFarFluid(boxes);
  boxes.nodes += R"("table": {"type": "TurningModel", "params": {"segments": 32,
                              "profile": [[0, -0.1], [0.5, -0.1], [0.5, 0], [0, 0]]}},
      "moved": {"type": "SemiAnalyticalSFI", "params": {"angular_velocity": [0, 1, 0]}}, )";
  boxes.links += R"("table.surface -> moved.solids", "table.surface -> contacts.solids", )";
  Trial run(boxes);
  run.advance(40);
  const BodyState state = run.state();
  const double angle = std::atan2(-state.center.z, state.center.x);
  const Vec3d side = rotate(state.rotation, Vec3d{1, 0, 0});
  std::printf("carried to %.4f rad at %.4f m, turned by %.4f rad\n", angle,
              std::hypot(state.center.x, state.center.z), std::atan2(-side.z, side.x));
  EXPECT_NEAR(angle, 2, 0.01);
  EXPECT_NEAR(std::hypot(state.center.x, state.center.z), 0.3, 3e-3);
  EXPECT_NEAR(std::atan2(-side.z, side.x), 2, 0.05);
}

/// The rod would fall to hang down; it stops 30 degrees below the horizontal.
TEST(BulletDynamics, AHingeStopsAtItsLimit) {
  for (const bool turned : {false, true}) {
    Boxes boxes{.floor = ""};
    boxes.add({0.1, 0.01, 0.01}, turned ? R"("density": 500, "position": [-0.1, 0, 0])"
                                        : R"("density": 500, "position": [0.1, 0, 0])");
    boxes.join(turned ? R"("axis": [0, 0, 1], "limits": [-10, 30])"
                      : R"("axis": [0, 0, 1], "limits": [-30, 10])");
    Trial run(boxes);
    run.advance(60);
    const Vec3d center = run.state().center;
    const double below = std::atan2(-center.y, std::abs(center.x)) * 180 / std::numbers::pi;
    std::printf("hangs %.3f degrees below the horizontal, turns by %.2g rad/s\n", below,
                length(run.motion().angular));
    EXPECT_NEAR(below, 30, 0.5);
    EXPECT_LT(length(run.motion().angular), 0.02);
  }
}

TEST(BulletDynamics, ASliderStopsAtItsLimits) {
  for (const double way : {1, -1}) {
    Boxes boxes{.floor = ""};
    boxes.add({0.05, 0.05, 0.05}, R"("density": 500)");
    boxes.join(fmt::format(R"("kind": "slider", "axis": [0, {}, 0], "limits": [{}, {}])", way,
                           way > 0 ? -0.3 : -0.1, way > 0 ? 0.1 : 0.3));
    Trial run(boxes);
    run.advance(60);
    EXPECT_NEAR(run.state().center.y, -0.3, 1e-3);
    EXPECT_LT(length(run.state().velocity), 1e-2);
  }
}

/// Of the body relative to the world, along the axis.
TEST(BulletDynamics, AMotorMovesASlider) {
  Boxes boxes{.gravity = 0, .floor = ""};
  boxes.add({0.05, 0.05, 0.05}, R"("density": 500)");
  boxes.join(R"("kind": "slider", "axis": [1, 0, 0], "motor": true, "speed": 0.2, "max_effort": 50)");
  Trial run(boxes);
  run.advance(20);
  EXPECT_NEAR(run.state().velocity.x, 0.2, 2e-3);
  EXPECT_NEAR(run.state().center.x, 0.2, 5e-3);
}

/// A top precesses steadily, its axis level, at Ω = m·g·l/(I₃·ω): level, this is exact at any rate.
TEST(BulletDynamics, ATopPrecesses) {
  Boxes boxes{.floor = ""};
  constexpr double kRate = 60, kArm = 0.1, kRadius = 0.05, kSide = 0.1;
  // Along x, of square section; two moments of a square prism are equal, so it is a symmetric top.
  const double mass = 1, inertia = mass * (kSide * kSide) / 6,
               precession = mass * kGravity * kArm / (inertia * kRate);
  boxes.add({0.02, kRadius, kRadius}, fmt::format(R"("mass": 1, "position": [{}, 0, 0],
      "angular_velocity": [{}, {}, 0], "velocity": [0, 0, {}])",
                                                  kArm, kRate, precession, -precession * kArm));
  boxes.join(R"("kind": "ball", "anchor": [0, 0, 0])");
  Trial run(boxes);
  double turned = 0, last = 0, lowest = 0;
  for (int frame = 0; frame < 20; ++frame) {
    run.advance(1);
    const Vec3d c = run.state().center;
    const double angle = std::atan2(-c.z, c.x);
    turned += std::remainder(angle - last, 2 * std::numbers::pi);
    last = angle;
    lowest = std::min(lowest, c.y);
  }
  std::printf("a top precesses by %.5f of %.5f rad, and sinks by %.2g m\n", turned, precession, -lowest);
  EXPECT_NEAR(turned / precession, 1, 0.005);
  EXPECT_NEAR(lowest, 0, 0.002);
  EXPECT_NEAR(length(run.state().center), kArm, 1e-4);
}

/// A bowl that stands on its rim over a box, whose hollow it would fill as a hull; and one that is a hull.
TEST(BulletDynamics, HollowBodiesKeepTheirHollow) {
  for (const bool hull : {false, true}) {
    Boxes boxes;
    boxes.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0, 0.0501, 0], "restitution": 0)");
    boxes.nodes += fmt::format(R"("cup": {{"type": "TurningModel", "params": {{"segments": 24,
          "profile": [[0, 0.23], [0.15, 0.23], [0.15, 0], [0.12, 0], [0.12, 0.2], [0, 0.2]]}}}},
        "b1": {{"type": "RigidBody", "params": {{"density": 500, "restitution": 0, "position": [0, {}, 0],
                "contact_shape": "{}"}}}}, )",
                               hull ? 0.11 : 0.01, hull ? "hull" : "mesh");
    boxes.links +=
        R"("cup.surface -> b1.mesh", "b1.body -> contacts.bodies", "floor.boundary -> b1.walls", )";
    Trial run(boxes);
    run.advance(30);
    const double rim = run.state(1).center.y - run.body(1).massOf().center.y;
    std::printf("the rim is at %.5f m, the box at %.5f m; the cup moves at %.2g m/s\n", rim,
                run.state().center.y, length(run.state(1).velocity));
    EXPECT_NEAR(rim, hull ? 0.1 : 0, 2e-3);
    EXPECT_NEAR(run.state().center.y, 0.05, 2e-3);
    EXPECT_LT(length(run.state(1).velocity), 0.02);
  }
}

/// The friction is √(μ₁·μ₂): of three boxes on a fourth that is tilted, those slide whose own is too little.
TEST(BulletDynamics, BodiesOfSeveralMaterialsHaveTheirOwnFriction) {
  const double slope = 0.3, angle = std::atan(slope), degrees = angle * 180 / std::numbers::pi;
  Boxes boxes{.floor = ""};
  boxes.add({0.5, 0.05, 0.5}, fmt::format(R"("density": 500, "rotation": [0, 0, {}], "wall_friction": 0.4,
                                             "fixed": "xyz", "fixed_rotation": "xyz")",
                                          degrees));
  const double frictions[] = {0.1, 0.2, 0.4};  // √(0.4·μ): 0.2, 0.283, 0.4
  for (int k = 0; k < 3; ++k)
    boxes.add({0.04, 0.04, 0.04}, fmt::format(R"("density": 500, "rotation": [0, 0, {}], "wall_friction": {},
        "restitution": 0, "position": [{}, {}, {}])",
                                              degrees, frictions[k], -0.09 * std::sin(angle),
                                              0.09 * std::cos(angle), 0.2 * (k - 1)));
  Trial run(boxes);
  run.advance(10);
  for (int k = 0; k < 3; ++k) {
    const Vec3d start{-0.09 * std::sin(angle), 0.09 * std::cos(angle), 0.2 * (k - 1)};
    const double friction = std::sqrt(0.4 * frictions[k]);
    const double way =
        friction > slope ? 0 : 0.125 * kGravity * (std::sin(angle) - friction * std::cos(angle));
    const double slid = length(run.state(1 + k).center - start);
    std::printf("friction %.3f at a slope of %.3f: slid by %.5f of %.5f m\n", friction, slope, slid, way);
    EXPECT_NEAR(slid, way, 0.05 * way + 1e-3);
  }
}

TEST(BulletDynamics, TheSameBitsForAnyNumberOfThreadsAndOnResume) {
  Boxes boxes = stack(3);
  boxes.add({0.04, 0.03, 0.05}, R"("density": 700, "rotation": [10, 20, 30], "position": [0.03, 0.5, 0.01])");
  Trial one(boxes, 1), four(boxes, 4);
  one.advance(10);
  four.advance(10);
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(one.state(k).center, four.state(k).center);
    EXPECT_EQ(one.state(k).rotation, four.state(k).rotation);
    EXPECT_EQ(one.state(k).velocity, four.state(k).velocity);
  }
  EXPECT_EQ(resumedSceneDifferences(boxes.text(), {.savedAt = 8, .comparedFor = 4}, {}, addBullet),
            std::vector<std::string>{});
}

/// A step of bodies depends on nothing that they cannot touch: a thin plate that flies 60 mm beside them, and
/// whose steps have more parts.
TEST(BulletDynamics, WhatIsOutOfReachDoesNotChangeABit) {
  constexpr int kCount = 3;
  Boxes near = stack(kCount), both = stack(kCount);
  both.add({0.002, 0.05, 0.05}, R"("density": 500, "position": [0.117, 0.15, 0], "velocity": [0, 2, 0])");
  Trial alone(near), beside(both);
  alone.advance(5);
  beside.advance(5);
  for (int k = 0; k < kCount; ++k) {
    EXPECT_EQ(alone.state(k).center, beside.state(k).center);
    EXPECT_EQ(alone.state(k).rotation, beside.state(k).rotation);
    EXPECT_EQ(alone.state(k).velocity, beside.state(k).velocity);
    EXPECT_EQ(alone.state(k).spin, beside.state(k).spin);
  }
}

/// The second box, at rest, reaches the third only as the first one pushes it, 5 mm on, in that step.
TEST(BulletDynamics, ABodyThatIsPushedMeetsOthersInTheSameStep) {
  Boxes boxes{.gravity = 0, .floor = ""};
  const std::string material = R"("mass": 1, "restitution": 0, "wall_friction": 0, )";
  boxes.add({0.05, 0.05, 0.05}, material + R"("velocity": [10, 0, 0], "position": [-0.101, 0, 0])");
  boxes.add({0.05, 0.05, 0.05}, material + R"("position": [0, 0, 0])");
  boxes.add({0.05, 0.05, 0.05}, material + R"("position": [0.105, 0, 0])");
  Trial run(boxes);
  double nearest = 1;
  const std::atomic<bool> stop = false;
  run.scene->advanceFrame(
      stop, [&] { nearest = std::min(nearest, run.state(2).center.x - run.state(1).center.x - 0.1); });
  std::printf("the boxes come as near as %.2g m\n", nearest);
  EXPECT_GT(nearest, -1e-6);
  EXPECT_NEAR(run.state(0).velocity.x + run.state(1).velocity.x + run.state(2).velocity.x, 10, 1e-9);
}

TEST(BulletDynamics, RefusesBadInput) {
  const auto refusalOf = [](const Boxes& boxes) {
    return std::string(errorOf([&] { Trial run(boxes); }).what());
  };
  Boxes within;
  within.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0, 0.1, 0])");
  within.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0.05, 0.1, 0])");
  EXPECT_CONTAINS(refusalOf(within), "m deep within 'b");
  Boxes still;
  still.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0, 0.1, 0])");
  still.nodes += R"("ground": {"type": "BoxMesh", "params": {"min": [-1, -0.3, -1], "max": [1, 0.07, 1]}}, )";
  still.links += R"("ground.surface -> contacts.solids", )";
  EXPECT_CONTAINS(refusalOf(still), "'b0' starts 0.02 m deep within a solid");
  Boxes lonely;
  lonely.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0, 0.1, 0])");
  lonely.join(R"("axis": [0, 0, 0])");
  EXPECT_CONTAINS(refusalOf(lonely), "the axis has no length");
  lonely.nodes.clear(), lonely.links.clear(), lonely.count = 0;
  lonely.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0, 0.1, 0])");
  lonely.join(R"("kind": "slider", "limits": [0.1, 0.2])");
  EXPECT_CONTAINS(refusalOf(lonely), "found limits of 0.1 and 0.2");
  lonely.nodes.clear(), lonely.links.clear(), lonely.count = 0;
  lonely.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0, 0.1, 0])");
  lonely.join(R"("limits": [-200, 0])");
  EXPECT_CONTAINS(refusalOf(lonely), "both between -175 and 175 degrees");
  Boxes stranger;
  stranger.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [0, 0.1, 0])");
  stranger.join(R"("kind": "fixed")");
  const std::string link = R"("b0.body -> contacts.bodies", )";
  stranger.links.erase(stranger.links.find(link), link.size());
  stranger.add({0.05, 0.05, 0.05}, R"("density": 500, "position": [1, 0.1, 0])");
  EXPECT_CONTAINS(refusalOf(stranger), "the joint 'joint' holds 'b0', which is not among the bodies");
}

}  // namespace
}  // namespace weir::test
