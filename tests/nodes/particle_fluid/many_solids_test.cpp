// What a fluid feels of a hundred solids, and they of it, is what it feels of each alone, and takes memory by
// the pairs of particles and solids that are near each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "nodes/particle_fluid/modules/solid_contact.h"
#include "nodes/particle_fluid/modules/wall_integrals.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.015f;
constexpr int kSide = 10;              // solids, in a square
constexpr float kCell = 4 * kSpacing;  // of one of them
constexpr float kHalf = kSpacing;      // of a cube

Vec3f centerOf(int k) {
  return {(float(k % kSide) + 0.5f) * kCell, 0, (float(k / kSide) + 0.5f) * kCell};
}

class Placed final : public RigidMotion {
 public:
  explicit Placed(int solid) : solid_(solid) {}
  Pose poseAt(double) const override { return {Quatf{}, centerOf(solid_)}; }
  Vec3f pivotAt(double) const override { return {0, 0.1f * float(solid_), 0}; }

 private:
  int solid_;
};

float distanceToCube(const Vec3f& p, const Vec3f& center) {
  Vec3f out{};
  for (int axis = 0; axis < 3; ++axis) out[axis] = std::max(std::abs(p[axis] - center[axis]) - kHalf, 0.0f);
  return length(out);
}

/// Around the cubes, and above them.
std::vector<Vec3f> water() {
  std::vector<Vec3f> all;
  for (const Vec3f& p : jitteredCube(kSide * 4, kSpacing, 0.3f, 5, {0, -0.06f, 0})) {
    bool free = p.y < 0.1f;
    for (int k = 0; k < kSide * kSide; ++k) free = free && distanceToCube(p, centerOf(k)) > 0.3f * kSpacing;
    if (free) all.push_back(p);
  }
  return all;
}

class ManySolids : public OnDevice {
 protected:
  void SetUp() override {
    OnDevice::SetUp();
    particles_.emplace(*device);
    neighbors_.emplace(*device);
    const std::vector<Vec3f> positions = water();
    ParticleBatch batch;
    batch.assign(*device, positions, std::vector<Vec3f>(positions.size()));
    particles_->append(batch);
    neighbors_->configure(constants_.supportRadius, 64);
    neighbors_->build(*particles_, everywhere_);
    count_ = particles_->refreshCount();
    for (int k = 0; k < kSide * kSide; ++k) {
      motions_.push_back(std::make_unique<Placed>(k));
      const Vec3f corner{kHalf, kHalf, kHalf};
      solids_.push_back(std::make_unique<Solid>(*device, boxMesh(-corner, corner), SolidSurface{},
                                                *motions_.back(), kSpacing));
    }
  }

  FluidStep stepWith(WallField& walls) {
    return {time(), *device, constants_, *particles_, *neighbors_, none_, everywhere_, {}, walls};
  }
  const StepContext& time() {
    if (!time_) time_.emplace(StepContext{*device, log_, {}, 0, kDt, 0});
    return *time_;
  }
  void findWith(WallField& walls) {
    walls.place(0, kDt);
    FluidStep step = stepWith(walls);
    WallIntegrals().findWalls(step);
  }
  std::vector<Vec4f> totalOf(const WallField& walls) const { return walls.total.toHost(count_); }

  static constexpr double kDt = 1e-3;
  const FluidConstants constants_ = makeFluidConstants(kSpacing, 1.5f, 1000, 1e6f, Calibration::kPacking);
  const Aabb everywhere_{{-9, -9, -9}, {9, 9, 9}};
  const std::vector<const Boundary*> none_;
  Log log_{[](LogLevel, std::string_view) {}};
  std::optional<StepContext> time_;
  std::optional<ParticleSet> particles_;
  std::optional<NeighborList> neighbors_;
  std::vector<std::unique_ptr<Placed>> motions_;
  std::vector<std::unique_ptr<Solid>> solids_;
  std::int64_t count_ = 0;
};
WEIR_ON_EVERY_DEVICE(ManySolids);

TEST_P(ManySolids, AreFeltAsEachAloneAndFeelWhatPressureDoes) {
  WallField walls(*device);
  for (const auto& solid : solids_) walls.solids.push_back(solid.get());
  const std::size_t before = device->memoryUse().inUse;
  findWith(walls);
  const std::size_t held = device->memoryUse().inUse - before;
  // A tenth of what 20 bytes for each particle and solid would be.
  EXPECT_LT(double(held), 0.1 * 20 * double(solids_.size()) * double(particles_->capacity()));

  // What the solver would say that walls displaced particles by, over ∇Φ.
  std::vector<float> share(static_cast<std::size_t>(count_));
  for (std::size_t i = 0; i < share.size(); ++i) share[i] = -1e-9f * float(i % 7);
  walls.share.assign(share);
  FluidStep step = stepWith(walls);
  SolidContact().step(step);

  const std::vector<Vec4f> total = totalOf(walls);
  const std::vector<Vec3f> positions = particles_->positions().toHost(count_);
  std::vector<Vec4f> sum(share.size());
  std::vector<int> meetings(share.size());
  for (std::size_t k = 0; k < solids_.size(); ++k) {
    WallField alone(*device);
    alone.solids.push_back(solids_[k].get());
    findWith(alone);
    const std::vector<Vec4f> felt = totalOf(alone);
    SolidImpulse expected{};
    double size = 0;
    for (std::size_t i = 0; i < felt.size(); ++i) {
      sum[i] = {sum[i].x + felt[i].x, sum[i].y + felt[i].y, sum[i].z + felt[i].z, sum[i].w + felt[i].w};
      meetings[i] += felt[i].w > 0;
      const Vec3d impulse = -double(constants_.particleMass) / kDt * double(share[i]) *
                            toDouble(Vec3f{felt[i].x, felt[i].y, felt[i].z});
      const Vec3d arm = toDouble(positions[i]) - toDouble(motions_[k]->pivotAt(0));
      expected += {impulse, cross(arm, impulse)};
      size += length(impulse);
    }
    const SolidImpulse found = solids_[k]->impulse().toHost().front();
    EXPECT_GT(size, 0);
    EXPECT_LT(length(found.linear - expected.linear), 1e-5 * size) << k;
    EXPECT_LT(length(found.angular - expected.angular), 1e-5 * size * (1 + 0.1 * double(k))) << k;
  }
  for (std::size_t i = 0; i < sum.size(); ++i) ASSERT_EQ(total[i], sum[i]) << i;
  EXPECT_GT(std::count_if(meetings.begin(), meetings.end(), [](int m) { return m > 1; }), 500);
  EXPECT_GT(std::count(meetings.begin(), meetings.end(), 0), 500);
}

// Solids come nearer: there is room for the pairs of every step.
TEST_P(ManySolids, RoomGrowsWithThePairs) {
  WallField walls(*device);
  walls.solids.push_back(solids_[0].get());
  findWith(walls);
  for (std::size_t k = 1; k < solids_.size(); ++k) walls.solids.push_back(solids_[k].get());
  findWith(walls);
  EXPECT_EQ(walls.pairs.lostOnHost(), 0);
  const std::vector<Vec4f> total = totalOf(walls);
  WallField fresh(*device);
  fresh.solids = walls.solids;
  findWith(fresh);
  EXPECT_EQ(totalOf(fresh), total);
}

}  // namespace
}  // namespace weir::test
