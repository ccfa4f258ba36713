// Sweeps over rows of contacts and joints, against the conditions that they are to meet.
#include "plugins/bodies/impulse_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace weir::test {
namespace {

constexpr SweepLimits kEnd{.maxSweeps = 100000, .tolerance = 1e-14};

double dot(const Vec6d& a, const Vec6d& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// Bodies of a mass and of moments of inertia of their own; the first does not move.
struct Bodies {
  std::mt19937 random{7};
  std::vector<Vec6d> roots;  // of the inverse masses

  explicit Bodies(std::size_t count) {
    roots.push_back(Vec6d{});
    while (roots.size() < count) roots.push_back(numbers(0.7, 1.4));
  }
  double number(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); }
  Vec6d numbers(double lo, double hi) {
    Vec6d six;
    for (double& x : six) x = number(lo, hi);
    return six;
  }
  /// Along a direction of its own.
  ScaledJacobian jacobian(std::size_t a, std::size_t b) {
    ScaledJacobian jacobian{numbers(-1, 1), numbers(-1, 1)};
    for (std::size_t k = 0; k < 6; ++k) {
      jacobian.a[k] *= roots[a][k];
      jacobian.b[k] *= roots[b][k];
    }
    return jacobian;
  }
  ImpulseRow row(std::size_t a, std::size_t b, double speed) {
    ImpulseRow row = makeRow(jacobian(a, b), {std::uint32_t(a), std::uint32_t(b)});
    row.target = speed;
    row.lower = -std::numeric_limits<double>::infinity();
    row.upper = std::numeric_limits<double>::infinity();
    return row;
  }
  ImpulseRow contact(std::size_t a, std::size_t b, double speed) {
    ImpulseRow row = this->row(a, b, speed);
    row.lower = 0;
    return row;
  }
  FrictionRows frictionOf(std::size_t a, std::size_t b, double friction, FrictionRows::Two speed) {
    const std::array<ScaledJacobian, 2> jacobians{jacobian(a, b), jacobian(a, b)};
    FrictionRows rows = weir::makeFriction(jacobians, {std::uint32_t(a), std::uint32_t(b)});
    rows.friction = friction;
    rows.target = speed;
    return rows;
  }
};

double speedOf(const ScaledJacobian& jacobian, BodyPair bodies, const VelocityChanges& changes) {
  return dot(jacobian.a, changes[bodies.a]) + dot(jacobian.b, changes[bodies.b]);
}
double speedOf(const ImpulseRow& row, const VelocityChanges& changes) {
  return speedOf(row.jacobian, row.bodies, changes);
}

TEST(ImpulseRows, JointsGetTheSpeedsThatTheyWant) {
  Bodies bodies(5);
  ImpulseRows rows;
  for (std::size_t k = 0; k < 12; ++k)
    rows.joints.push_back(bodies.row(k % 5, (k + 1 + k / 5) % 5, bodies.number(-1, 1)));
  VelocityChanges changes(5, Vec6d{});
  sweep(rows, changes, kEnd);
  for (const ImpulseRow& row : rows.joints) EXPECT_NEAR(speedOf(row, changes), row.target, 1e-9);
  EXPECT_EQ(changes[0], Vec6d{});
}

/// J·v = b − ε·λ.
TEST(ImpulseRows, SoftJointsGiveWay) {
  Bodies bodies(2);
  ImpulseRows rows;
  ImpulseRow soft = makeRow(bodies.jacobian(0, 1), {0, 1}, 0.3);
  soft.target = 1, soft.lower = -10, soft.upper = 10;
  rows.joints.push_back(soft);
  VelocityChanges changes(2, Vec6d{});
  sweep(rows, changes, kEnd);
  EXPECT_NEAR(speedOf(rows.joints[0], changes), 1 - 0.3 * rows.joints[0].impulse, 1e-12);
  EXPECT_GT(rows.joints[0].impulse, 0);
}

/// λ ≥ 0, v ≥ b, λ·(v − b) = 0.
TEST(ImpulseRows, ContactsPushAndDoNotPull) {
  Bodies bodies(6);
  ImpulseRows rows;
  for (std::size_t k = 0; k < 15; ++k)
    rows.contacts.push_back(bodies.contact(k % 6, (k + 1 + k / 6) % 6, bodies.number(-1, 1)));
  VelocityChanges changes(6, Vec6d{});
  sweep(rows, changes, kEnd);
  int pushing = 0;
  for (const ImpulseRow& row : rows.contacts) {
    const double lacks = row.target - speedOf(row, changes);
    EXPECT_GE(row.impulse, 0);
    EXPECT_LT(lacks, 1e-9);
    EXPECT_NEAR(row.impulse * lacks, 0, 1e-9);
    pushing += row.impulse > 0 ? 1 : 0;
  }
  EXPECT_GT(pushing, 3);
  EXPECT_LT(pushing, 15);
}

/// |λ| ≤ μ·N in all directions; what is below that bound stops its bodies, and what is at it acts along what
/// is lacking.
TEST(ImpulseRows, FrictionIsBoundedByItsContact) {
  for (const double friction : {0.1, 10.0}) {
    Bodies bodies(2);
    ImpulseRows rows;
    rows.contacts.push_back(bodies.contact(0, 1, 1));
    rows.frictions.push_back(bodies.frictionOf(0, 1, friction, {2, -1}));
    VelocityChanges changes(2, Vec6d{});
    sweep(rows, changes, kEnd);
    const FrictionRows& of = rows.frictions.front();
    const double normal = rows.contacts.front().impulse;
    const auto lack = [&](std::size_t k) {
      return of.target[k] - speedOf(of.jacobians[k], of.bodies, changes);
    };
    EXPECT_GT(normal, 0);
    const double size = std::hypot(of.impulse[0], of.impulse[1]);
    if (friction < 1) {
      EXPECT_NEAR(size, friction * normal, 1e-12);
      EXPECT_NEAR(of.impulse[0] * lack(1) - of.impulse[1] * lack(0), 0, 1e-10);
      EXPECT_GT(of.impulse[0] * lack(0) + of.impulse[1] * lack(1), 0);
    } else {
      EXPECT_LT(size, friction * normal);
      EXPECT_NEAR(lack(0), 0, 1e-9);
      EXPECT_NEAR(lack(1), 0, 1e-9);
    }
  }
}

TEST(ImpulseRows, AContactThatDoesNothingDoesNotRub) {
  Bodies bodies(2);
  ImpulseRows rows;
  rows.contacts.push_back(bodies.contact(0, 1, -1));
  rows.frictions.push_back(bodies.frictionOf(0, 1, 0.5, {2, -1}));
  rows.contacts.front().impulse = 1;
  rows.frictions.front().impulse = {0.1, 0.1};
  VelocityChanges changes(2, Vec6d{});
  sweep(rows, changes, {.maxSweeps = 1, .tolerance = 0});
  rows.contacts.front().target = -100;
  sweep(rows, changes, kEnd);
  EXPECT_EQ(rows.contacts.front().impulse, 0);
  EXPECT_EQ(rows.frictions.front().impulse, (FrictionRows::Two{0, 0}));
}

TEST(ImpulseRows, EndsOnceNothingChangesByMoreThanIsAllowed) {
  Bodies bodies(4);
  ImpulseRows rows;
  for (std::size_t k = 0; k < 6; ++k) rows.joints.push_back(bodies.row(k % 4, (k + 1) % 4, 1));
  const ImpulseRows begun = rows;
  VelocityChanges exact(4, Vec6d{}), rough(4, Vec6d{}), none(4, Vec6d{});
  const int many = sweep(rows, exact, kEnd);
  rows = begun;
  const int fewer = sweep(rows, rough, {.maxSweeps = 100000, .tolerance = 1e-3});
  rows = begun;
  EXPECT_EQ(sweep(rows, none, {.maxSweeps = 0, .tolerance = 0}), 0);
  double off = 0;
  for (std::size_t b = 0; b < 4; ++b)
    for (std::size_t k = 0; k < 6; ++k) off = std::max(off, std::abs(rough[b][k] - exact[b][k]));
  EXPECT_GT(off, 0);
  EXPECT_LT(off, 0.1);
  EXPECT_LT(fewer, many);
  EXPECT_EQ(none, VelocityChanges(4, Vec6d{}));
}

/// A column of bodies, each on the one below, which all are to stop: the load of all is on the lowest.
TEST(ImpulseRows, SweepsFollowTheHeightOfAColumn) {
  const auto sweepsFor = [](std::size_t count) {
    ImpulseRows rows;
    for (std::size_t k = 0; k < count; ++k) {
      ScaledJacobian jacobian;
      jacobian.b[0] = 1;
      jacobian.a[0] = k == 0 ? 0 : -1;
      rows.contacts.push_back(makeRow(jacobian, {std::uint32_t(k), std::uint32_t(k + 1)}));
      rows.contacts.back().upper = std::numeric_limits<double>::infinity();
    }
    VelocityChanges changes(count + 1, Vec6d{-1});
    changes[0] = {};
    const int sweeps = sweep(rows, changes, {.maxSweeps = 100000, .tolerance = 1e-6});
    EXPECT_NEAR(rows.contacts.front().impulse, double(count), 1e-3 * double(count));
    return sweeps;
  };
  EXPECT_LT(sweepsFor(40), 3 * sweepsFor(20));
  EXPECT_LT(sweepsFor(40), 400);
}

}  // namespace
}  // namespace weir::test
