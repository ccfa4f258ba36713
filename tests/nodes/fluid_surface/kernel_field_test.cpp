#include "nodes/fluid_surface/kernel_field.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <map>
#include <optional>

#include "tests/support/devices.h"
#include "tests/support/fluid_scene.h"

namespace weir {
namespace {

Eigen::Vector3d toEigen(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

/// The equations of particle_kernels.h, one after another in double.
class SlowField {
 public:
  SlowField(const std::vector<Vec3f>& positions, const KernelSettings& s) : s_(s) {
    for (const Vec3f& p : positions) kernels_.push_back(kernelAt(toEigen(p), positions));
  }

  double at(const Vec3f& x) const {
    double sum = 0;
    for (const Kernel& k : kernels_) {
      const double square = (k.g * (toEigen(x) - k.center)).squaredNorm();
      if (square < 1)
        sum +=
            std::pow(double(s_.spacing), 3) * 315 / (64 * M_PI) * std::pow(1 - square, 3) * k.g.determinant();
    }
    return sum;
  }

 private:
  struct Kernel {
    Eigen::Vector3d center;
    Eigen::Matrix3d g;
  };

  Kernel kernelAt(const Eigen::Vector3d& x, const std::vector<Vec3f>& positions) const {
    const double reach = s_.radius;
    double weights = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    const auto weightOf = [&](const Eigen::Vector3d& y) {
      const double q = (y - x).norm() / reach;
      return q < 1 ? 1 - q * q * q : 0;
    };
    for (const Vec3f& p : positions)
      weights += weightOf(toEigen(p)), mean += weightOf(toEigen(p)) * toEigen(p);
    mean /= weights;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Vec3f& p : positions) {
      const Eigen::Vector3d d = toEigen(p) - mean;
      covariance += weightOf(toEigen(p)) / weights * d * d.transpose();
    }
    const double full = 2 * M_PI / 3 * std::pow(reach / s_.spacing, 3);
    const double blend = std::clamp((weights / full - 0.1) / 0.2, 0.0, 1.0);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
    Eigen::Vector3d axes;
    for (int k = 0; k < 3; ++k) {
      // Of particles in a plane one is 0, or a bit less.
      const double axis = std::sqrt(std::max(
          {0.0, eigen.eigenvalues()[k], eigen.eigenvalues()[2] / std::pow(double(s_.anisotropy), 2)}));
      axes[k] = s_.loneAxis + blend * (std::clamp(axis / std::sqrt(0.15) / reach, 0.25, 2.0) - s_.loneAxis);
    }
    return {x + s_.smoothing * (mean - x), eigen.eigenvectors() * axes.cwiseInverse().asDiagonal() *
                                               eigen.eigenvectors().transpose() / double(s_.radius)};
  }

  KernelSettings s_;
  std::vector<Kernel> kernels_;
};

/// A block of disordered fluid, a sheet, a thread and two lone particles.
std::vector<Vec3f> bodies(float d, const Vec3f& corner) {
  std::vector<Vec3f> all = test::jitteredCube(6, d, 0.2f, 5, corner);
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j)
      all.push_back(corner + d * Vec3f{10.0f + 0.7f * float(i), float(j), 0.7f * float(i)});
  for (int i = 0; i < 10; ++i) all.push_back(corner + d * Vec3f{float(i), 10, 0.1f * float(i)});
  all.push_back(corner + d * Vec3f{0, 15, 0});
  all.push_back(corner + d * Vec3f{1.1f, 15, 0});
  return all;
}

/// What a grid holds, by node.
class HostGrid {
 public:
  explicit HostGrid(const SparseGrid& grid) : values_(grid.values().toHost()) {
    const std::vector<std::uint64_t> keys = grid.keys().toHost();
    for (std::size_t b = 0; b < keys.size(); ++b) blocks_[keys[b]] = b;
  }
  /// Nothing where there is no block.
  std::optional<float> at(const Vec3i& n) const {
    const auto found = blocks_.find(BlockKey::of({n.x >> 3, n.y >> 3, n.z >> 3}));
    if (found == blocks_.end()) return std::nullopt;
    return values_[found->second * BlockKey::kNodes + GridView::local({n.x & 7, n.y & 7, n.z & 7})];
  }
  std::size_t blocks() const { return blocks_.size(); }

 private:
  std::vector<float> values_;
  std::map<std::uint64_t, std::size_t> blocks_;
};

using KernelFieldTest = test::OnDevice;

TEST_P(KernelFieldTest, IsTheSumOfTheEquationsAndHasBlocksAroundIt) {
  const float d = 0.02f, cell = 0.5f * d;
  const Vec3f corner{-0.03f, 0.1f, -0.05f};
  const std::vector<Vec3f> positions = bodies(d, corner);
  ParticleKernels kernels(*device);
  KernelField field(*device);
  for (const KernelSettings& settings :
       {KernelSettings{.spacing = d, .radius = 2 * d, .smoothing = 0.9f, .anisotropy = 4, .loneAxis = 0.3f},
        KernelSettings{.spacing = d, .radius = 1.5f * d, .anisotropy = 1}}) {
    const SlowField slow(positions, settings);
    kernels.make(*device, Array<Vec3f>(*device, std::span<const Vec3f>(positions)).view(),
                 std::ssize(positions), settings, 100);
    field.make(*device, kernels, cell);
    const HostGrid grid(field.grid());
    for (int z = -20; z < 40; z += 3)
      for (int y = -5; y < 50; y += 2)
        for (int x = -15; x < 45; ++x) {
          const double expected = slow.at(cell * Vec3f{float(x), float(y), float(z)});
          EXPECT_NEAR(grid.at({x, y, z}).value_or(0), expected, 2e-4) << x << ' ' << y << ' ' << z;
          if (expected < 1e-3) continue;
          for (int k = 0; k < 8; ++k) EXPECT_TRUE(grid.at({x - (k & 1), y - (k >> 1 & 1), z - (k >> 2)}));
        }
  }
}

TEST_P(KernelFieldTest, CostsFollowTheParticlesAndNotTheirBox) {
  const std::vector<Vec3f> far{{-900, -900, -900}, {900, 900, 900}, {900, 900, 900}};
  ParticleKernels kernels(*device);
  KernelField field(*device);
  kernels.make(*device, Array<Vec3f>(*device, std::span<const Vec3f>(far)).view(), 3,
               {.spacing = 0.02f, .radius = 0.04f, .smoothing = 1, .anisotropy = 4}, 1000);
  field.make(*device, kernels, 0.01f);
  EXPECT_LE(HostGrid(field.grid()).blocks(), 16u);
}

TEST_P(KernelFieldTest, LeavesOutWhatIsNoPlaceOrTooFarAway) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), huge = std::numeric_limits<float>::max();
  const std::vector<Vec3f> bad{{nan, 0, 0}, {0, 0, 0}, {huge, 0, 0}, {0, -huge, 0}, {0, 0, 1e5f}};
  const float farthest = KernelField::farthest(0.01f, 0.04f);
  ParticleKernels kernels(*device);
  KernelField field(*device);
  kernels.make(*device, Array<Vec3f>(*device, std::span<const Vec3f>(bad)).view(), std::ssize(bad),
               {.spacing = 0.02f, .radius = 0.04f, .anisotropy = 4}, farthest);
  EXPECT_EQ(kernels.size(), 1);
  field.make(*device, kernels, 0.01f);
  EXPECT_LE(HostGrid(field.grid()).blocks(), 8u);
  const std::vector<Vec3f> edge{{farthest, -farthest, farthest}};
  kernels.make(*device, Array<Vec3f>(*device, std::span<const Vec3f>(edge)).view(), 1,
               {.spacing = 0.02f, .radius = 0.04f, .anisotropy = 4}, farthest);
  field.make(*device, kernels, 0.01f);
  EXPECT_GE(HostGrid(field.grid()).blocks(), 1u);
}

WEIR_ON_EVERY_DEVICE(KernelFieldTest);

}  // namespace
}  // namespace weir
