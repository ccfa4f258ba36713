// Landscapes: closed, as high as they should be, the same for the same seed, and refused where they make no
// sense.
#include "nodes/terrain/terrain.h"

#include <gtest/gtest.h>

#include <map>

#include "framework/graph/scene_graph.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

TriangleMesh terrain(const Value& parameters, std::int64_t seed = 1) {
  const auto device = openDevice("cpu");
  Log log;
  Registry registry;
  SceneGraph graph;
  auto& node = static_cast<Terrain&>(graph.add(std::make_unique<Terrain>(), "ground"));
  node.assignAll(parameters, {});
  graph.reset({*device, log, registry, {}, 1e-3, seed});
  return *node.surface;
}

const Value kSteps = Value::Array{Value::Array{-1, 2.0}, Value::Array{0, 2.0}, Value::Array{0.5, 0.5}};

TEST(Terrain, IsAGoodClosedSolid) {
  for (const int cells : {1, 7, 40})
    for (const double width : {1.0, 3.0}) {
      const TriangleMesh mesh = terrain(object({{"size", Value::Array{2.0, width}},
                                                {"cells", cells},
                                                {"profile", kSteps},
                                                {"channel_width", 0.8},
                                                {"channel_depth", 0.3},
                                                {"roughness", 0.1},
                                                {"rocks", 12}}));
      EXPECT_TRUE(diagnose(mesh).good()) << cells << ": " << diagnose(mesh).message();
    }
}

TEST(Terrain, AFlatOneIsABoxInItsPlace) {
  const TriangleMesh mesh = terrain(object({{"size", Value::Array{3, 2}},
                                            {"thickness", 0.5},
                                            {"position", Value::Array{10, 20, 30}},
                                            {"cells", 6}}));
  EXPECT_NEAR(mesh.volume(), 3 * 2 * 0.5, 1e-3);
  const Aabb box = mesh.bounds();
  EXPECT_NEAR(box.lo.x, 8.5, 1e-5);
  EXPECT_NEAR(box.hi.x, 11.5, 1e-5);
  EXPECT_NEAR(box.lo.y, 19.5, 1e-5);
  EXPECT_NEAR(box.hi.y, 20, 1e-5);
  EXPECT_NEAR(box.lo.z, 29, 1e-5);
  EXPECT_EQ(mesh.triangles.size(), std::size_t(6 * 4 * 2 + 3 * 20));
}

TEST(Terrain, OnesOfOneSeedGoOnInEachOtherByTheirOffsets) {
  const auto border = [](double middle, double offset) {
    const TriangleMesh mesh = terrain(object({{"size", Value::Array{4, 4}},
                                              {"cells", 16},
                                              {"roughness", 0.3},
                                              {"feature_size", 1.5},
                                              {"seed", 7},
                                              {"bump_offset", Value::Array{offset, 0}},
                                              {"position", Value::Array{middle, 0, 0}}}));
    std::map<float, float> heights;  // of the upper side at x = 2, by z
    for (const Vec3f& v : mesh.vertices)
      if (std::abs(v.x - 2) < 1e-4f)
        heights[v.z] = std::max(v.y, heights.try_emplace(v.z, -1.0f).first->second);
    return heights;
  };
  const auto left = border(0, 0), right = border(4, 4), other = border(4, 0);
  ASSERT_EQ(left.size(), 17u);
  ASSERT_EQ(right.size(), left.size());
  float apart = 0;
  for (const auto& [z, height] : left) {
    EXPECT_NEAR(right.at(z), height, 1e-4) << z;
    apart = std::max(apart, std::abs(other.at(z) - height));
  }
  EXPECT_GT(apart, 0.1f);
}

TEST(Heightfield, FollowsItsProfileAndItsChannel) {
  const Heightfield field(
      {.size = {4, 4}, .profile = {{-1, 2}, {0, 2}, {0.5f, 0.5f}}, .channelWidth = 1, .channelDepth = 0.25f});
  EXPECT_NEAR(field.height(-2, 1), 2, 1e-6);
  EXPECT_NEAR(field.height(-0.5, 1), 2, 1e-6);
  EXPECT_NEAR(field.height(0.25, 1), 1.25, 1e-6);
  EXPECT_NEAR(field.height(3, 1), 0.5, 1e-6);
  EXPECT_NEAR(field.height(-0.5, 0), 1.75, 1e-6);      // in the middle of the channel
  EXPECT_NEAR(field.height(-0.5, 0.25), 1.875, 1e-6);  // half way up its bank
  EXPECT_NEAR(field.height(-0.5, 0.5), 2, 1e-6);
}

TEST(Heightfield, NoiseStaysInItsBoundsAndHasNoJumps) {
  const Heightfield field({.roughness = 0.1f, .featureSize = 0.5f, .octaves = 3, .seed = 5});
  constexpr double kMax = 0.1 * (1 + 0.5 + 0.25);
  // An octave changes by at most 2·amplitude·(15/8) over a cell, and all octaves are equally steep.
  constexpr double kSteepest = 3 * 2 * 0.1 * 1.875 / 0.5 * 2;
  constexpr double kStep = 1e-3;
  double low = 0, high = 0;
  for (double x = -2; x < 2; x += 0.0137) {
    const double h = field.height(x, 0.3 * x);
    low = std::min(low, h), high = std::max(high, h);
    EXPECT_LT(std::abs(field.height(x + kStep, 0.3 * x) - h), kSteepest * kStep);
  }
  EXPECT_GT(low, -kMax);
  EXPECT_LT(high, kMax);
  EXPECT_GT(high - low, 0.5 * kMax);
}

TEST(Heightfield, RocksStandOutOfTheGround) {
  const HeightfieldShape bare{.size = {4, 4}};
  HeightfieldShape rocky = bare;
  rocky.rocks = 20;
  rocky.rockSize = {0.2f, 0.3f};
  const Heightfield field(rocky);
  double highest = 0;
  int above = 0, all = 0;
  for (double x = -2; x <= 2; x += 0.02)
    for (double z = -2; z <= 2; z += 0.02, ++all) {
      const double h = field.height(x, z);
      highest = std::max(highest, h);
      above += h > 0;
      EXPECT_GE(h, 0);
    }
  EXPECT_GT(highest, 0.1);
  EXPECT_LT(highest, 0.33);
  // 20 discs of radius 0.25 in 16 m², some of them overlapping or over the edge.
  EXPECT_GT(double(above) / all, 0.1);
  EXPECT_LT(double(above) / all, 0.26);
}

TEST(Terrain, RocksStandInTheirRange) {
  const Value rocky = object({{"size", Value::Array{4, 1}},
                              {"rocks", 30},
                              {"rock_size", Value::Array{0.1, 0.1}},
                              {"rock_range", Value::Array{0.5, 1}},
                              {"cells", 80}});
  Aabb raised;
  for (const Vec3f& v : terrain(rocky).vertices)
    if (v.y > 0) raised.extend(v);
  EXPECT_GT(raised.lo.x, 0.4f);
  EXPECT_LT(raised.hi.x, 1.1f);
  EXPECT_GT(raised.hi.x - raised.lo.x, 0.3f);
}

TEST(Terrain, TheSeedDecides) {
  const Value rough = object({{"roughness", 0.1}, {"rocks", 5}, {"cells", 10}});
  EXPECT_EQ(terrain(rough, 1).vertices, terrain(rough, 1).vertices);
  EXPECT_NE(terrain(rough, 1).vertices, terrain(rough, 2).vertices);
}

TEST(Terrain, SaysWhatIsWrong) {
  Terrain node;
  const auto expect = [&](const Value& parameters, const char* parameter, const char* part) {
    const Error e = errorOf([&] { node.assignAll(parameters, {}); });
    EXPECT_EQ(e.kind(), ErrorKind::kScene);
    EXPECT_EQ(e.location().parameter, parameter);
    EXPECT_CONTAINS(e.what(), part);
  };
  expect(object({{"profile", Value::Array{Value::Array{0, 1}, Value::Array{0, 2}}}}), "profile",
         "point 1 of the profile, at x = 0");
  expect(object({{"rock_size", Value::Array{0.3, 0.1}}}), "rock_size", "[0.3, 0.1]");
  expect(object({{"rock_range", Value::Array{1, -1}}}), "rock_range", "[1, -1]");
  expect(object({{"channel_depth", 0.3}}), "channel_depth", "no width");
  expect(object({{"size", Value::Array{0, 1}}}), "size", "above 0");
  expect(object({{"cells", 0}}), "cells", "at least 1");
}

}  // namespace
}  // namespace weir::test
