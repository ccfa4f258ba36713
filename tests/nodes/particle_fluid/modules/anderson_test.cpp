// Anderson's acceleration alone, of iterations whose fixed points are known.
#include "nodes/particle_fluid/modules/anderson.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/devices.h"

namespace weir::test {
namespace {

using AndersonMixingTest = OnDevice;

/// What the solver does around the mixing.
class Mixer {
 public:
  Mixer(Device& device, const std::vector<Vec3f>& start, bool shares)
      : device_(device),
        displacement_(device, start),
        predicted_(device, std::vector<Vec3f>(start.size(), kPredicted)),
        state_(device, std::vector<Vec4f>(start.size())),
        share_(device, std::vector<float>(shares ? start.size() : 0)),
        control_(device, 1) {
    mixing_.reserve(device, displacement_.size(), shares);
  }

  /// Lets f make a plain iterate and mixes it with earlier ones.
  template <class F>
  void iterate(const F& f) {
    control.momentum = control.sinceRestart > 0 ? 1 : 0;
    ++control.sinceRestart;
    control.entry = AndersonHistory::after(control.entry);
    const std::vector<Vec3f> u = displacement_.toHost();
    device_.copy(mixing_.view().starts.data + control.entry * mixing_.view().stride, displacement_.data(),
                 u.size() * sizeof(Vec3f));
    std::vector<Vec3f> next;
    for (std::size_t i = 0; i < u.size(); ++i) next.push_back(f(i, u[i]));
    put(next);
  }
  void takeBack() {
    control.takesBack = 1;
    control.sinceRestart = 0;
    mix();
    control.takesBack = 0;
  }

  std::vector<Vec3f> displacement() { return displacement_.toHost(); }
  std::vector<float> shares() { return share_.toHost(); }
  std::vector<Vec4f> state() { return state_.toHost(); }

  static constexpr Vec3f kPredicted{1, 2, 3};
  SolverControl control;

 private:
  void put(const std::vector<Vec3f>& plain) {
    displacement_.assign(plain);
    std::vector<float> shares;
    for (const Vec3f& u : plain) shares.push_back(u.x + 2 * u.y - u.z);
    if (!share_.empty()) share_.assign(shares);
    mix();
  }
  void mix() {
    control_.assign(std::vector<SolverControl>{control});
    mixing_.mix(device_, displacement_.size(), control_.data(),
                {displacement_.view(), share_.view(), std::as_const(predicted_).view(), state_.view()});
  }

  Device& device_;
  Array<Vec3f> displacement_, predicted_;
  Array<Vec4f> state_;
  Array<float> share_;
  Array<SolverControl> control_;
  AndersonMixing mixing_;
};

constexpr std::size_t kParticles = 5000;  // more than one block of a reduction

/// f(u) = u* + a·(u − u*), with a factor of its own for each component: three in all.
struct Linear {
  static constexpr float kFactors[3] = {0.9f, 0.5f, -0.6f};

  Vec3f fixedPoint(std::size_t i) const { return {1 + float(i % 7), 2 - float(i % 3), float(i % 5)}; }
  Vec3f operator()(std::size_t i, const Vec3f& u) const {
    const Vec3f p = fixedPoint(i);
    return {p.x + kFactors[0] * (u.x - p.x), p.y + kFactors[1] * (u.y - p.y),
            p.z + kFactors[2] * (u.z - p.z)};
  }
};

double error(const std::vector<Vec3f>& u) {
  double max = 0;
  for (std::size_t i = 0; i < u.size(); ++i)
    max = std::max(max, double(length(u[i] - Linear{}.fixedPoint(i))));
  return max;
}

// The residual of the m-th mixture is that of GMRES: with three factors, the third is exact.
TEST_P(AndersonMixingTest, SolvesThreeModesInThreeMixtures) {
  Mixer mixer(*device, std::vector<Vec3f>(kParticles), true);
  for (int k = 0; k < 4; ++k) {
    EXPECT_GT(error(mixer.displacement()), 0.1) << "after " << k;
    mixer.iterate(Linear{});
  }
  EXPECT_LT(error(mixer.displacement()), 1e-3);
  // What is a linear function of the displacement stays one; states follow.
  const std::vector<Vec3f> u = mixer.displacement();
  const std::vector<float> shares = mixer.shares();
  const std::vector<Vec4f> state = mixer.state();
  for (std::size_t i = 0; i < u.size(); ++i) {
    EXPECT_NEAR(shares[i], u[i].x + 2 * u[i].y - u[i].z, 1e-4);
    const Vec3f p = Mixer::kPredicted + u[i];
    EXPECT_EQ(state[i], (Vec4f{p.x, p.y, p.z, 0}));
  }
}

TEST_P(AndersonMixingTest, FirstIterateAfterARestartIsPlain) {
  Mixer mixer(*device, std::vector<Vec3f>(kParticles), false);
  for (int k = 0; k < 3; ++k) mixer.iterate(Linear{});
  mixer.control.sinceRestart = 0;
  const std::vector<Vec3f> before = mixer.displacement();
  mixer.iterate(Linear{});
  const std::vector<Vec3f> after = mixer.displacement();
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after[i], Linear{}(i, before[i]));
}

TEST_P(AndersonMixingTest, GoesOnByMomentumAloneWhereMixturesAreExhausted) {
  Mixer mixer(*device, std::vector<Vec3f>(kParticles), true);
  std::vector<Vec3f> start[2];
  for (int k = 0; k < 6; ++k) {
    mixer.control.exhausted = k > 3;
    start[0] = start[1];
    start[1] = mixer.displacement();
    mixer.iterate(Linear{});
  }
  const std::vector<Vec3f> u = mixer.displacement();
  const std::vector<float> shares = mixer.shares();
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Vec3f now = Linear{}(i, start[1][i]), before = Linear{}(i, start[0][i]);
    EXPECT_EQ(u[i], now + mixer.control.momentum * (now - before));
    EXPECT_NEAR(shares[i], u[i].x + 2 * u[i].y - u[i].z, 1e-4);
  }
}

TEST_P(AndersonMixingTest, TakesBackToTheLastPlainIterate) {
  for (const int iterations : {2, 6}) {  // before and after the ring is full
    Mixer mixer(*device, std::vector<Vec3f>(kParticles), true);
    std::vector<Vec3f> start;
    for (int k = 0; k < iterations; ++k) {
      start = mixer.displacement();
      mixer.iterate(Linear{});
    }
    mixer.takeBack();
    const std::vector<Vec3f> u = mixer.displacement();
    const std::vector<float> shares = mixer.shares();
    for (std::size_t i = 0; i < u.size(); ++i) {
      EXPECT_EQ(u[i], Linear{}(i, start[i]));
      EXPECT_EQ(shares[i], u[i].x + 2 * u[i].y - u[i].z);
    }
  }
}

// Residuals that do not differ have nothing to tell, and one that is NaN must not reach the others.
TEST_P(AndersonMixingTest, IsPlainWhereThereIsNothingToSolve) {
  const auto moving = [](std::size_t, const Vec3f& u) { return u + Vec3f{0.5f, 0.25f, 1}; };
  Mixer mixer(*device, std::vector<Vec3f>(kParticles), false);
  for (int k = 1; k < 6; ++k) {
    mixer.iterate(moving);
    for (const Vec3f& u : mixer.displacement()) ASSERT_EQ(u, float(k) * Vec3f({0.5f, 0.25f, 1})) << k;
  }
  Mixer broken(*device, std::vector<Vec3f>(kParticles), false);
  const auto breaking = [](std::size_t i, const Vec3f& u) {
    return i == 7 ? Vec3f{std::numeric_limits<float>::quiet_NaN(), 0, 0} : Linear{}(i, u);
  };
  std::vector<Vec3f> before;
  for (int k = 0; k < 4; ++k) {
    before = broken.displacement();
    broken.iterate(breaking);
  }
  const std::vector<Vec3f> after = broken.displacement();
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (i == 7) continue;
    EXPECT_EQ(after[i], Linear{}(i, before[i]));
  }
}

TEST_P(AndersonMixingTest, HoldsMemoryUntilItIsReleased) {
  const std::size_t before = device->memoryUse().inUse;
  AndersonMixing mixing;
  EXPECT_TRUE(mixing.view().empty());
  mixing.reserve(*device, kParticles, true);
  EXPECT_GE(device->memoryUse().inUse, before + 112 * kParticles);
  const std::uint64_t allocations = device->memoryUse().allocations;
  mixing.reserve(*device, kParticles, true);
  EXPECT_EQ(device->memoryUse().allocations, allocations);
  mixing.release();
  EXPECT_TRUE(mixing.view().empty());
  EXPECT_EQ(device->memoryUse().inUse, before);
}

WEIR_ON_EVERY_DEVICE(AndersonMixingTest);

}  // namespace
}  // namespace weir::test
