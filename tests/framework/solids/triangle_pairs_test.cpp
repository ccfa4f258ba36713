// Triangles by eights against triangles one by one, in double and in float.
#include "framework/solids/triangle_pairs.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "framework/solids/solid_integrals.h"
#include "tests/support/meshes.h"

#ifdef WEIR_HAS_LANES

namespace weir::test {
namespace {

constexpr float kH = 0.3f;
constexpr float kFullD = 15 / (kH * kH);

Vec3d inDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

struct Asked {
  Vec3f p;
  std::vector<int> triangles;
};

std::vector<int> trianglesNear(const TriangleTreeView& tree, const Vec3f& p) {
  std::vector<int> found(TrianglePairs::kMax);
  found.resize(static_cast<std::size_t>(WalkNear(tree, p, kH).next(found.data(), TrianglePairs::kMax)));
  return found;
}

/// Both integrators add all triangles, and then what is behind them.
template <class T>
SolidIntegrals<T> integralsOf(SolidIntegrator<T>& sum, bool insideWhenFar, const auto& addAll,
                              const auto& fillAll) {
  addAll(sum);
  if (sum.isOutside()) fillAll(sum);
  return sum.integrals(1, insideWhenFar);
}

template <class T>
SolidIntegrals<T> oneByOne(const TriangleTreeView& tree, const Asked& asked, bool turned,
                           bool insideWhenFar = false) {
  const auto at = [](const Vec3f& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
  SolidIntegrator<T> sum(at(asked.p), T(kH));
  const auto corners = [&](int i, auto&& f) {
    const detail::TreeTriangle& t = tree.triangles[i];
    f(at(t.a), at(turned ? t.c : t.b), at(turned ? t.b : t.c));
  };
  return integralsOf(
      sum, insideWhenFar,
      [&](auto& s) {
        for (const int i : asked.triangles) corners(i, [&](auto... v) { s.addTriangle(v...); });
      },
      [&](auto& s) {
        for (const int i : asked.triangles) corners(i, [&](auto... v) { s.fillBehind(v...); });
      });
}

SolidIntegrals<float> byPairs(const TrianglePairs& pairs, int particle, const Vec3f& p,
                              bool insideWhenFar = false) {
  SolidIntegrator<float> sum(p, kH);
  return integralsOf(
      sum, insideWhenFar,
      [&](auto& s) { pairs.forEachTriangle(particle, [&](const auto& terms) { s.add(terms); }); },
      [&](auto& s) { pairs.forEachTriangle(particle, [&](const auto& terms) { s.fillBehind(terms); }); });
}

class TrianglePairsTest : public testing::Test {
 protected:
  /// Particles near the mesh, each with the triangles near it.
  static std::vector<Asked> around(const TriangleTreeView& tree, int count) {
    std::mt19937 random(11);
    std::normal_distribution<float> away(0, 0.4f * kH);
    std::uniform_real_distribution<float> share(0, 1);
    std::vector<Asked> asked;
    for (int i = 0; i < count; ++i) {
      const detail::TreeTriangle& t = tree.triangles[static_cast<std::int64_t>(
          share(random) * 0.999f * static_cast<float>(tree.triangles.size))];
      const float u = share(random), v = (1 - u) * share(random);
      // Some stand on faces, edges and corners.
      const float off = i % 5 == 0 ? 0.0f : 1.0f;
      const Vec3f p = t.a + u * (t.b - t.a) + (i % 10 == 0 ? 0 : v) * (t.c - t.a) +
                      off * Vec3f{away(random), away(random), away(random)};
      asked.push_back({p, trianglesNear(tree, p)});
    }
    return asked;
  }

  const std::unique_ptr<TrianglePairs> pairs_ = std::make_unique<TrianglePairs>();
};

TEST_F(TrianglePairsTest, HaveTheIntegralsOfTrianglesOneByOne) {
  CpuDevice device(1);
  int max = 0, deep = 0;
  // Large triangles, smaller than H, and so small that points inside them do; a thin plate.
  for (const TriangleMesh& mesh : {boxMesh({-1, -1, -1}, {1, 1, 1}), icosphere(1), icosphere(3),
                                   icosphere(4, 0.5f), boxMesh({-1, -1, -0.05f}, {1, 1, 0.05f})}) {
    const TriangleTree tree(device, mesh);
    for (const bool turned : {false, true}) {
      const std::vector<Asked> asked = around(tree.view(), 600);
      for (std::size_t next = 0; next < asked.size();) {
        pairs_->clear();
        const std::size_t begin = next;
        for (; next < asked.size() && pairs_->hasRoom(int(asked[next].triangles.size())); ++next)
          pairs_->add(asked[next].p, asked[next].triangles.data(), int(asked[next].triangles.size()));
        ASSERT_GT(next, begin) << "a particle has too many triangles for this test";
        max = std::max(max, int(next - begin));
        pairs_->evaluate(tree.view(), turned, kH);
        for (std::size_t i = begin; i < next; ++i) {
          const int particle = int(i - begin);
          const Vec3f p = asked[i].p;
          SCOPED_TRACE(testing::Message() << mesh.triangles.size() << ", " << i << ", " << turned);
          // Where next to nothing, or next to all, is solid, floats cannot tell which, and integrals() takes
          // the caller's word. Without it, both ways make the same of it.
          const SolidIntegrals<double> exact = oneByOne<double>(tree.view(), asked[i], turned);
          const SolidIntegrals<float> found = byPairs(*pairs_, particle, p, exact.phi > 0.5);
          EXPECT_NEAR(found.phi, exact.phi, 2e-4);
          EXPECT_NEAR(found.d / kFullD, exact.d / kFullD, 2e-4);
          EXPECT_LT(length(inDouble(found.gradPhi) - exact.gradPhi) * double(kH), 1e-3);
          const SolidIntegrals<float> untold = byPairs(*pairs_, particle, p),
                                      scalar = oneByOne<float>(tree.view(), asked[i], turned);
          EXPECT_NEAR(untold.phi, scalar.phi, 5e-5);
          EXPECT_NEAR(untold.d / kFullD, scalar.d / kFullD, 1e-4);
          EXPECT_LT(length(untold.gradPhi - scalar.gradPhi) * kH, 1e-3f);
          deep += exact.phi > 0.5 && untold.phi < 0.5f;
        }
      }
    }
  }
  EXPECT_EQ(max, TrianglePairs::kMaxParticles);
  EXPECT_GT(deep, 0) << "no point of which floats cannot tell whether it is deep inside";
}

/// What stands in the other lanes must not matter: results would depend on the number of threads.
TEST_F(TrianglePairsTest, DoNotDependOnTheirCompany) {
  CpuDevice device(1);
  const TriangleTree tree(device, icosphere(2));
  const std::vector<Asked> asked = around(tree.view(), 200);
  const auto add = [&](std::size_t i) {
    pairs_->add(asked[i].p, asked[i].triangles.data(), int(asked[i].triangles.size()));
  };
  int compared = 0;
  for (std::size_t i = 3; i < asked.size(); ++i) {
    pairs_->clear();
    add(i);
    pairs_->evaluate(tree.view(), false, kH);
    const SolidIntegrals<float> alone = byPairs(*pairs_, 0, asked[i].p);
    const int sides = pairs_->sidesSeen(0);
    pairs_->clear();
    for (std::size_t k = i - 3; k <= i; ++k) add(k);
    pairs_->evaluate(tree.view(), false, kH);
    const SolidIntegrals<float> together = byPairs(*pairs_, 3, asked[i].p);
    EXPECT_EQ(together.phi, alone.phi) << i;
    EXPECT_EQ(together.d, alone.d) << i;
    EXPECT_EQ(together.gradPhi, alone.gradPhi) << i;
    EXPECT_EQ(pairs_->sidesSeen(3), sides) << i;
    compared += alone.phi > 0;
  }
  EXPECT_GT(compared, 50);
}

TEST_F(TrianglePairsTest, SeeTheSidesThatEachTriangleShows) {
  CpuDevice device(1);
  const TriangleTree tree(device, boxMesh({-1, -1, -0.05f}, {1, 1, 0.05f}));
  for (const Asked& asked : around(tree.view(), 200)) {
    int sides = 0;
    for (const int i : asked.triangles) {
      const detail::TreeTriangle& t = tree.view().triangles[i];
      sides |= sidesSeen(asked.p, t.a, t.b, t.c);
    }
    pairs_->clear();
    pairs_->add(asked.p, asked.triangles.data(), int(asked.triangles.size()));
    pairs_->evaluate(tree.view(), false, kH);
    EXPECT_EQ(pairs_->sidesSeen(0), sides);
  }
}

TEST(LaneAngles, AreThoseOfTheStandardLibrary) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> exponent(-30, 30), turn(-3.14159f, 3.14159f);
  for (int i = 0; i < 20000; ++i) {
    const float size = std::exp2(exponent(random)), angle = turn(random);
    float y[8], x[8];
    for (int l = 0; l < 8; ++l)
      y[l] = size * std::sin(angle + 0.1f * float(l)), x[l] = size * std::cos(angle);
    const Lanes found = atan2(Lanes::load(y), Lanes::load(x));
    for (int l = 0; l < 8; ++l) ASSERT_NEAR(found.v[l], std::atan2(double(y[l]), double(x[l])), 3e-7);
  }
  const float y[8] = {0, 0, 1, -1, -0.0f, 1, -1, 1}, x[8] = {1, -1, 0, 0, -2, 1, -1, -1};
  const double expected[8] = {0,           3.14159265, 1.57079633,  -1.57079633,
                              -3.14159265, 0.78539816, -2.35619449, 2.35619449};
  const Lanes found = atan2(Lanes::load(y), Lanes::load(x));
  for (int l = 0; l < 8; ++l) EXPECT_NEAR(found.v[l], expected[l], 3e-7) << l;
}

}  // namespace
}  // namespace weir::test

#endif
