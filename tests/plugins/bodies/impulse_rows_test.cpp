// Sweeps over rows of contacts and joints, against the conditions that they are to meet.
#include "plugins/bodies/impulse_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace weir::test {
namespace {

constexpr SweepsEnd kEnd{.maxSweeps = 100000, .tolerance = 1e-14};

double dot(const Six& a, const Six& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

/// Bodies of a mass and of moments of inertia of their own; the first does not move.
struct Bodies {
  std::mt19937 random{7};
  std::vector<Six> inverses;

  explicit Bodies(std::size_t count) {
    inverses.push_back(Six{});
    while (inverses.size() < count) inverses.push_back(numbers(0.5, 2));
  }
  double number(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); }
  Six numbers(double lo, double hi) {
    Six six;
    for (double& x : six) x = number(lo, hi);
    return six;
  }
  /// Wants that speed along a direction of its own.
  ImpulseRow row(std::size_t a, std::size_t b, double speed) {
    ImpulseRow row{.directionA = numbers(-1, 1), .directionB = numbers(-1, 1), .a = a, .b = b};
    for (std::size_t k = 0; k < 6; ++k) {
      row.changeA[k] = inverses[a][k] * row.directionA[k];
      row.changeB[k] = inverses[b][k] * row.directionB[k];
    }
    row.mobility = dot(row.directionA, row.changeA) + dot(row.directionB, row.changeB);
    row.inverse = 1 / row.mobility;
    row.wanted = speed * row.inverse;
    row.lower = -std::numeric_limits<double>::infinity();
    row.upper = std::numeric_limits<double>::infinity();
    return row;
  }
};

double speedOf(const ImpulseRow& row, const Changes& changes) {
  return dot(row.directionA, changes[row.a]) + dot(row.directionB, changes[row.b]);
}

TEST(ImpulseRows, JointsGetTheSpeedsThatTheyWant) {
  Bodies bodies(5);
  std::vector<ImpulseRow> joints, contacts;
  std::vector<FrictionRow> frictions;
  for (std::size_t k = 0; k < 12; ++k)
    joints.push_back(bodies.row(k % 5, (k + 1 + k / 5) % 5, bodies.number(-1, 1)));
  Changes changes(5, Six{});
  sweep(joints, contacts, frictions, changes, kEnd);
  for (const ImpulseRow& row : joints) EXPECT_NEAR(speedOf(row, changes), row.wanted * row.mobility, 1e-9);
  EXPECT_EQ(changes[0], Six{});
}

/// λ ≥ 0, v ≥ b, λ·(v − b) = 0.
TEST(ImpulseRows, ContactsPushAndDoNotPull) {
  Bodies bodies(6);
  std::vector<ImpulseRow> joints, contacts;
  std::vector<FrictionRow> frictions;
  for (std::size_t k = 0; k < 15; ++k) {
    contacts.push_back(bodies.row(k % 6, (k + 1 + k / 6) % 6, bodies.number(-1, 1)));
    contacts.back().lower = 0;
  }
  Changes changes(6, Six{});
  sweep(joints, contacts, frictions, changes, kEnd);
  int pushing = 0;
  for (const ImpulseRow& row : contacts) {
    const double lacks = row.wanted * row.mobility - speedOf(row, changes);
    EXPECT_GE(row.impulse, 0);
    EXPECT_LT(lacks, 1e-9);
    EXPECT_NEAR(row.impulse * lacks, 0, 1e-9);
    pushing += row.impulse > 0 ? 1 : 0;
  }
  EXPECT_GT(pushing, 3);
  EXPECT_LT(pushing, 15);
}

/// |λ| ≤ μ·N; what is below that bound stops its bodies.
TEST(ImpulseRows, FrictionIsBoundedByItsContact) {
  for (const double friction : {0.1, 10.0}) {
    Bodies bodies(2);
    std::vector<ImpulseRow> joints, contacts{bodies.row(0, 1, 1)};
    contacts.front().lower = 0;
    std::vector<FrictionRow> frictions{{bodies.row(0, 1, 2), friction, 0}};
    Changes changes(2, Six{});
    sweep(joints, contacts, frictions, changes, kEnd);
    const ImpulseRow& row = frictions.front().row;
    EXPECT_GT(contacts.front().impulse, 0);
    if (friction < 1)
      EXPECT_NEAR(std::abs(row.impulse), friction * contacts.front().impulse, 1e-12);
    else
      EXPECT_NEAR(speedOf(row, changes), 2, 1e-9);
  }
}

TEST(ImpulseRows, EndsOnceNothingChangesByMoreThanIsAllowed) {
  Bodies bodies(4);
  std::vector<ImpulseRow> joints, contacts;
  std::vector<FrictionRow> frictions;
  for (std::size_t k = 0; k < 6; ++k) joints.push_back(bodies.row(k % 4, (k + 1) % 4, 1));
  const std::vector<ImpulseRow> begun = joints;
  Changes exact(4, Six{}), rough(4, Six{}), none(4, Six{});
  sweep(joints, contacts, frictions, exact, kEnd);
  joints = begun;
  sweep(joints, contacts, frictions, rough, {.maxSweeps = 100000, .tolerance = 1e-3});
  joints = begun;
  sweep(joints, contacts, frictions, none, {.maxSweeps = 0, .tolerance = 0});
  double off = 0;
  for (std::size_t b = 0; b < 4; ++b)
    for (std::size_t k = 0; k < 6; ++k) off = std::max(off, std::abs(rough[b][k] - exact[b][k]));
  EXPECT_GT(off, 0);
  EXPECT_LT(off, 0.1);
  EXPECT_EQ(none, Changes(4, Six{}));
}

}  // namespace
}  // namespace weir::test
