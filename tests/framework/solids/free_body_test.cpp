// Rigid bodies without a fluid: against closed forms and conservation.
#include "framework/solids/free_body.h"

#include <gtest/gtest.h>

#include <numbers>

namespace weir::test {
namespace {

BodyMass topOf(double a, double c) {
  return {.mass = 2, .center = {0.1, 0.2, 0.3}, .inertia = {.xx = a, .yy = a, .zz = c}};
}

BodyState spinning(const BodyMass& mass, const Quatd& rotation, const Vec3d& angular) {
  BodyState state;
  state.rotation = rotation;
  state.spin = product(mass.matrix(rotation), {{}, angular}).angular;
  return state;
}

double energyOf(const BodyMass& mass, const BodyState& state) {
  return 0.5 * dot(state.spin, twistOf(mass, state).angular);
}

TEST(FreeBody, SolvesWhatIsNotLocked) {
  TwistMatrix a;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j <= i; ++j) a.at(i, j) = i == j ? 10 + i : 1.0 / (1 + i + j);
  const Twist x{{1, -2, 3}, {0, 0.5, -1}};
  const Twist found = solved(a, product(a, x), 0);
  EXPECT_NEAR(length(found.linear - x.linear), 0, 1e-14);
  EXPECT_NEAR(length(found.angular - x.angular), 0, 1e-14);
  // The x that is zero already may be locked, and nothing changes.
  const Twist locked = solved(a, product(a, x), 1 << 3);
  EXPECT_NEAR(length(locked.linear - x.linear), 0, 1e-14);
  EXPECT_EQ(locked.angular.x, 0);
  EXPECT_EQ(solved(a, x, 0b000111).linear, (Vec3d{0, 0, 0}));
}

TEST(FreeBody, FallsAsParticlesOfAFluidDo) {
  const BodyMass mass = topOf(1, 2);
  BodyState state;
  state.velocity = {1, 2, 0};
  const double dt = 0.01, g = 9.8;
  const int steps = 100;
  for (int k = 0; k < steps; ++k) state = flown(mass, state, {0, -g, 0}, dt);
  EXPECT_NEAR(state.velocity.y, 2 - g * steps * dt, 1e-12);
  EXPECT_NEAR(state.center.x, 1, 1e-12);
  EXPECT_NEAR(state.center.y, 2 - g * dt * dt * steps * (steps + 1) / 2, 1e-12);  // its own closed form
  EXPECT_NEAR(state.center.y, 2 - 0.5 * g, 0.5 * g * dt + 1e-12);                 // and the parabola
}

/// The axis of a symmetric top goes around its angular momentum L with the angular velocity |L|/A (Euler).
TEST(FreeBody, ASymmetricTopPrecesses) {
  const double a = 0.02, c = 0.05;
  const BodyMass mass = topOf(a, c);
  const Quatd tilted = rotationBy({0.4, 0, 0});
  BodyState state = spinning(mass, tilted, rotate(tilted, {0, 3, 12}));
  const BodyState before = state;
  const double rate = length(state.spin) / a, period = 2 * std::numbers::pi / rate;
  const double energy = energyOf(mass, state);
  const auto axis = [](const BodyState& of) { return rotate(of.rotation, Vec3d{0, 0, 1}); };
  const int steps = 40;
  double farthest = 0;
  for (int k = 0; k < steps; ++k) {
    state = flown(mass, state, {}, period / steps);
    EXPECT_NEAR(dot(axis(state), state.spin), dot(axis(before), before.spin), 1e-6 * length(state.spin));
    EXPECT_NEAR(energyOf(mass, state) / energy, 1, 1e-6);
    EXPECT_EQ(state.spin, before.spin);
    farthest = std::max(farthest, length(axis(state) - axis(before)));
  }
  EXPECT_GT(farthest, 0.1);
  EXPECT_NEAR(length(axis(state) - axis(before)), 0, 1e-5);
}

/// About the middle axis it tumbles (Dzhanibekov): energy and momentum stay.
TEST(FreeBody, ATumblingBodyKeepsItsEnergy) {
  const BodyMass mass{.mass = 1, .center = {}, .inertia = {.xx = 1, .yy = 2, .zz = 3}};
  BodyState state = spinning(mass, {}, {0.01, 5, 0});
  const double energy = energyOf(mass, state);
  double least = 1;
  for (int k = 0; k < 2000; ++k) {
    state = flown(mass, state, {}, 0.005);
    least = std::min(least, rotate(state.rotation, Vec3d{0, 1, 0}).y);
    ASSERT_NEAR(energyOf(mass, state) / energy, 1, 1e-6);
  }
  EXPECT_LT(least, -0.9);
}

/// Held at an axis that is not its own, it turns steadily: what the bearing takes up is no torque along it.
TEST(FreeBody, TurnsAboutAHeldAxis) {
  BodyMass mass{.mass = 1, .center = {}, .inertia = {.xx = 1, .yy = 2, .zz = 3, .xy = 0.3, .zx = -0.2}};
  mass.locked = 0b101000;  // about x and z
  BodyState state;
  state.spin = mass.taken({{}, {7, 4, -5}}).angular;
  EXPECT_EQ(state.spin, (Vec3d{0, 4, 0}));
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(twistOf(mass, state).angular.x, 0);
    EXPECT_NEAR(twistOf(mass, state).angular.y, 2, 1e-6);
    state = flown(mass, state, {0, -9.8, 0}, 0.01);
  }
  EXPECT_NEAR(dot(rotate(state.rotation, Vec3d{1, 0, 0}), Vec3d{std::cos(2), 0, -std::sin(2)}), 1, 1e-6);
  EXPECT_EQ(flown({.mass = 1, .inertia = {1, 1, 1}, .locked = 0b010}, {}, {1, -9.8, 0}, 0.1).velocity,
            (Vec3d{0.1, 0, 0}));
}

TEST(FreeBody, PosesTakeTheMeshToTheWorld) {
  const BodyMass mass = topOf(1, 2);
  BodyState state;
  state.center = {5, 0, 0};
  state.rotation = rotationBy({0, 0, 0.5 * std::numbers::pi});
  const Vec3f center = poseOf(mass, state).toWorld(floatOf(mass.center));
  EXPECT_NEAR(center.x, 5, 1e-6);
  const Vec3f beside = poseOf(mass, state).toWorld(floatOf(mass.center + Vec3d{1, 0, 0}));
  EXPECT_NEAR(beside.x, 5, 1e-6);
  EXPECT_NEAR(beside.y, 1, 1e-6);
}

}  // namespace
}  // namespace weir::test
