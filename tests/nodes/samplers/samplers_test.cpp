// Counts, places and jitter of sampled particles.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <tuple>
#include <utility>

#include "nodes/samplers/box_sampler.h"
#include "nodes/samplers/sphere_sampler.h"
#include "tests/nodes/samplers/sampled.h"

namespace weir::test {
namespace {

double smallestDistance(const std::vector<Vec3f>& points) {
  double smallest = 1e30;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) smallest = std::min(smallest, double(length(points[i] - points[j])));
  return smallest;
}

TEST(BoxSampler, HoldsSizeOverSpacingParticlesHalfASpacingFromTheFaces) {
  for (const std::string& device : availableDevices())
    for (const auto& [nx, ny, nz, spacing] :
         {std::tuple{5, 4, 3, 0.1}, {1, 1, 1, 0.1}, {81, 3, 7, 0.01}, {50, 2, 33, 0.015}}) {
      const double x = -0.3, y = 2.1, z = 0.7;
      Sampled<BoxSampler> block(
          object({{"min", Value::Array{x, y, z}},
                  {"max", Value::Array{x + nx * spacing, y + ny * spacing, z + nz * spacing}},
                  {"velocity", Value::Array{1, -2, 3}}}),
          float(spacing), device);
      const std::vector<Vec3f> p = block.positions();
      ASSERT_EQ(p.size(), std::size_t(nx * ny * nz));
      // Nothing was rounded; but a region of one or two layers is said to be thin.
      ASSERT_EQ(block.warnings.size(), std::min({nx, ny, nz}) < 3 ? 1u : 0u);
      for (const std::string& warning : block.warnings) EXPECT_CONTAINS(warning, "spacings thick");
      std::size_t i = 0;
      for (int c = 0; c < nz; ++c)
        for (int b = 0; b < ny; ++b)
          for (int a = 0; a < nx; ++a, ++i) {
            EXPECT_NEAR(p[i].x, x + (a + 0.5) * spacing, 1e-6);
            EXPECT_NEAR(p[i].y, y + (b + 0.5) * spacing, 1e-6);
            EXPECT_NEAR(p[i].z, z + (c + 0.5) * spacing, 1e-6);
          }
      for (const Vec3f& v : block.velocities()) EXPECT_EQ(v, (Vec3f{1, -2, 3}));
    }
}

Value boxOf(const Vec3d& low, const Vec3d& size) {
  return object({{"min", Value::Array{low.x, low.y, low.z}},
                 {"max", Value::Array{low.x + size.x, low.y + size.y, low.z + size.z}}});
}

TEST(BoxSampler, HoldsItsVolumeWhateverItsSides) {
  std::mt19937 random(3);
  const double d = 0.1;
  const Vec3d low{-0.3, 2.1, 0.7};
  for (const auto& [shortest, longest, error] : {std::tuple{8, 16, 0.01}, {3, 8, 0.02}}) {
    std::uniform_real_distribution<double> side(shortest * d, longest * d);
    for (int k = 0; k < 20; ++k) {
      const Vec3d size = k == 0 ? Vec3d{shortest + 0.5, shortest + 0.5, shortest + 0.5} * d
                                : Vec3d{side(random), side(random), side(random)};
      SCOPED_TRACE(fmt::format("{} x {} x {}", size.x, size.y, size.z));
      Sampled<BoxSampler> block(boxOf(low, size), float(d));
      const std::vector<Vec3f> lattice = block.positions();
      // One particle is what rounding leaves.
      const double volume = size.x * size.y * size.z / (d * d * d);
      EXPECT_NEAR(double(lattice.size()), volume, std::max(1.0, error * volume));
      EXPECT_TRUE(block.warnings.empty());
      EXPECT_GT(smallestDistance(lattice), 0.8 * d);
      for (const Vec3f& p : lattice)
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_GT(p[axis], low[axis] + 0.2 * d);
          EXPECT_LT(p[axis], low[axis] + size[axis] - 0.2 * d);
        }
      block.asker().disordered = true;
      for (const float ratio : k == 0 ? std::vector<float>{1.5f, 2.0f, 2.4f} : std::vector<float>{}) {
        block.asker().supportRatio = ratio;
        EXPECT_EQ(block.positions().size(), lattice.size());
      }
    }
  }
}

TEST(BoxSampler, MayHoldAnyNumberOfParticlesInRowsThatAreEvenlySpaced) {
  // 7.5³ = 421.9, where 8³ is a fifth too many. 7 layers of 8 rows take 7 or 8 each.
  Sampled<BoxSampler> block(boxOf({}, {0.3, 0.3, 0.3}), 0.04f);
  const std::vector<Vec3f> p = block.positions();
  EXPECT_EQ(p.size(), 422u);
  Vec3d mean{};
  std::map<std::pair<float, float>, int> rows;
  for (const Vec3f& q : p) {
    mean += (1.0 / 422) * Vec3d{q.x, q.y, q.z};
    ++rows[{q.y, q.z}];
  }
  EXPECT_LT(length(mean - Vec3d{0.15, 0.15, 0.15}), 0.001);
  EXPECT_EQ(rows.size(), 56u);
  for (const auto& [row, count] : rows) EXPECT_EQ(count, std::clamp(count, 7, 8));
}

TEST(BoxSampler, RoundsThinBoxesToWholeParticlesAroundTheCentreAndSaysSo) {
  Sampled<BoxSampler> block(object({{"min", Value::Array{0, 0, 0}}, {"max", Value::Array{0.34, 0.26, 0.01}}}),
                            0.1f);
  const std::vector<Vec3f> p = block.positions();
  ASSERT_EQ(p.size(), 9u);
  Vec3f mean{};
  for (const Vec3f& q : p) mean += q / 9.0f;
  EXPECT_LT(length(mean - Vec3f{0.17f, 0.13f, 0.005f}), 1e-6f);
  EXPECT_NEAR(smallestDistance(p), 0.1, 1e-6);
  ASSERT_EQ(block.warnings.size(), 2u);
  EXPECT_CONTAINS(block.warnings[0], "block");
  EXPECT_CONTAINS(block.warnings[0], "% of the region's");
  EXPECT_CONTAINS(block.warnings[1], "0.1 spacings thick");
}

TEST(BoxSampler, JitterStaysInItsBoundsAndDependsOnTheSeedAlone) {
  const Value parameters =
      object({{"min", Value::Array{0, 0, 0}}, {"max", Value::Array{3, 3, 3}}, {"jitter", 0.25}});
  Sampled<BoxSampler> block(parameters, 0.1f);
  const std::vector<Vec3f> p = block.positions();
  ASSERT_EQ(p.size(), 27000u);  // two chunks
  double sum = 0, squares = 0, largest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double exact[3] = {0.05 + 0.1 * double(i % 30), 0.05 + 0.1 * double(i / 30 % 30),
                             0.05 + 0.1 * double(i / 900)};
    for (int axis = 0; axis < 3; ++axis) {
      const double moved = (p[i][axis] - exact[axis]) / 0.1;
      sum += moved, squares += moved * moved;
      largest = std::max(largest, std::abs(moved));
    }
  }
  // Uniform in ±0.25: mean 0, variance 0.25²/3; 81000 samples leave 4 standard errors of about 0.002.
  EXPECT_NEAR(sum / 81000, 0, 0.003);
  EXPECT_NEAR(squares / 81000 / (0.0625 / 3), 1, 0.02);
  EXPECT_LE(largest, 0.25 + 1e-4);
  EXPECT_GT(largest, 0.249);
  EXPECT_EQ(p, block.positions(1));
  EXPECT_NE(p, block.positions(2));
  EXPECT_EQ(p, (Sampled<BoxSampler>(parameters, 0.1f, "cpu", 1).positions(1)));
  EXPECT_EQ(p, (Sampled<BoxSampler>(parameters, 0.1f, "cpu", 3).positions(1)));
}

TEST(BoxSampler, FluidWithoutOrderGetsAsManyParticlesWithoutOrderInsideTheBox) {
  for (const std::string& device : availableDevices()) {
    const Value parameters = object({{"min", Value::Array{0, 0, 0}}, {"max", Value::Array{1.5, 1, 0.7}}});
    Sampled<BoxSampler> block(parameters, 0.1f, device);
    const std::vector<Vec3f> lattice = block.positions();
    EXPECT_EQ(block.node().particles->container, nullptr);
    block.asker().disordered = true;
    const std::vector<Vec3f> p = block.positions();
    ASSERT_EQ(p.size(), 15u * 10 * 7);
    ASSERT_NE(block.node().particles->container, nullptr);
    double moved = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      moved += length(p[i] - lattice[i]) / double(p.size());
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(p[i][axis], 0.05 - 1e-6);
        EXPECT_LE(p[i][axis], (Vec3f{1.45f, 0.95f, 0.65f}[axis]) + 1e-6);
      }
    }
    EXPECT_GT(moved, 0.02);
    block.node().assignAll(object({{"arrangement", "lattice"}}), {});
    EXPECT_EQ(block.positions(), lattice);
  }
}

TEST(SphereSampler, FluidWithoutOrderStaysInsideAndHasNoPressure) {
  Sampled<SphereSampler> drop(object({{"radius", 0.4}}), 0.05f);
  const std::size_t count = drop.positions().size();
  drop.asker().disordered = true;
  const std::vector<Vec3f> p = drop.positions();
  EXPECT_EQ(p.size(), count);
  EXPECT_EQ(drop.node().particles->pressure, StartPressure::kNone);
  for (const Vec3f& q : p) EXPECT_LE(length(q - Vec3f{0, 0.5f, 0}), 0.375 + 1e-5);
}

TEST(BoxSampler, TheParticlesAreThereInTheFirstStepOnly) {
  Sampled<BoxSampler> block(Value::object(), 0.1f);
  for (int run = 0; run < 2; ++run) {
    EXPECT_EQ(block.positions().size(), 125u);
    block.step(0);
    EXPECT_EQ(block.node().particles->count, 125);
    block.step(1);
    EXPECT_EQ(block.node().particles->count, 0);
    NodeReport report;
    block.node().report(report);
    EXPECT_EQ(report.statistics["particles_sampled"], Value(125));
  }
}

TEST(SphereSampler, CountIsTheVolumeOverTheCubeOfTheSpacing) {
  for (const double spacing : {0.05, 0.02, 0.01}) {
    Sampled<SphereSampler> drop(object({{"center", Value::Array{1, 2, 3}}, {"radius", 0.4}}), float(spacing));
    const std::vector<Vec3f> p = drop.positions();
    const double expected = 4 * std::numbers::pi / 3 * std::pow(0.4 / spacing, 3);
    // The error of a lattice count is far below one layer of particles.
    EXPECT_NEAR(double(p.size()), expected, 0.2 * 4 * std::numbers::pi * std::pow(0.4 / spacing, 2))
        << spacing;
    for (const Vec3f& q : p) EXPECT_LE(length(q - Vec3f{1, 2, 3}), 0.4 + 1e-6);
  }
  Sampled<SphereSampler> coarse(object({{"radius", 0.4}}), 0.1f);
  EXPECT_NEAR(smallestDistance(coarse.positions()), 0.1, 1e-6);
}

TEST(SphereSampler, CountIsWithinOnePercentFromRadiiOfEightSpacingsOn) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> radii(8, 12);
  for (int k = 0; k < 30; ++k) {
    const double r = k == 0 ? 8 : radii(random);  // around a particle, a ball of 8 has 1.7 % too few
    Sampled<SphereSampler> drop(object({{"radius", 0.1 * r}}), 0.1f);
    EXPECT_NEAR(double(drop.positions().size()) / (4 * std::numbers::pi / 3 * r * r * r), 1, 0.0101) << r;
  }
}

TEST(SphereSampler, TheSmallestHasOneParticleAndAJitteredOneStaysInside) {
  Sampled<SphereSampler> point(object({{"radius", 0.01}, {"center", Value::Array{1, 2, 3}}}), 0.1f);
  EXPECT_EQ(point.positions(), (std::vector<Vec3f>{{1, 2, 3}}));
  ASSERT_EQ(point.warnings.size(), 2u);
  EXPECT_CONTAINS(point.warnings[0], "% of the region's");
  EXPECT_CONTAINS(point.warnings[1], "0.2 spacings thick");
  Sampled<SphereSampler> drop(object({{"radius", 1}, {"center", Value::Array{0, 0, 0}}, {"jitter", 0.5}}),
                              0.1f);
  const std::vector<Vec3f> p = drop.positions();
  EXPECT_NEAR(double(p.size()), 4188.8, 80);
  for (const Vec3f& q : p) EXPECT_LE(length(q), 1);
}

TEST(Samplers, SayWhatIsWrong) {
  const Error order = errorOf([] {
    BoxSampler().assignAll(object({{"min", Value::Array{0, 0.5, 0}}, {"max", Value::Array{1, 0.5, 1}}}), {});
  });
  EXPECT_CONTAINS(order.what(), "from 0.5 to 0.5 m along y");
  EXPECT_EQ(order.kind(), ErrorKind::kScene);

  Sampled<BoxSampler> huge(object({{"max", Value::Array{1000, 1000, 1000}}}), 0.001f);
  const Error many = errorOf([&] { huge.positions(); });
  EXPECT_CONTAINS(many.what(), "1e+18");
  EXPECT_CONTAINS(many.what(), "at most 2147483647");
  EXPECT_EQ(many.location().node, "block");
  Sampled<BoxSampler> endless(
      object({{"min", Value::Array{-3e38, -3e38, -3e38}}, {"max", Value::Array{3e38, 3e38, 3e38}}}), 1e-30f);
  EXPECT_CONTAINS(errorOf([&] { endless.positions(); }).what(), "at most 2147483647");

  const auto device = openDevice("cpu");
  Log log;
  Registry registry;
  SceneGraph graph;
  graph.add(std::make_unique<SphereSampler>(), "drop");
  const Error alone = errorOf([&] { graph.reset({*device, log, registry, {}, 1e-3, 1}); });
  EXPECT_CONTAINS(alone.what(), "not linked to a fluid");
  EXPECT_EQ(alone.location().node, "drop");
}

}  // namespace
}  // namespace weir::test
