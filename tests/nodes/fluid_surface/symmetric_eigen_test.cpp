#include "nodes/fluid_surface/symmetric_eigen.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>
#include <vector>

namespace weir {
namespace {

/// Random rotations of given eigenvalues, some of them equal or nearly so.
std::vector<SymmetricMatrix> matrices() {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const std::vector<Vec3d> values{{3, 2, 1},    {1, 1, 1},     {2, 1, 1},         {2, 2, 1},
                                  {1, 0, 0},    {0, 0, 0},     {1, 1 - 1e-9, .5}, {1, .5, .5 - 1e-9},
                                  {1, -1, 0},   {5, 1e-6, -4}, {1e-8, 0, 0},      {1e6, 1e5, 1},
                                  {-1, -2, -2}, {1, 1e-7, 0}};
  std::vector<SymmetricMatrix> all;
  for (const Vec3d& v : values) {
    all.push_back({v.x, v.y, v.z, 0, 0, 0});
    for (int k = 0; k < 20; ++k) {
      const Eigen::Matrix3d q =
          Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
              .normalized()
              .matrix();
      const Eigen::Matrix3d a = q * Eigen::Vector3d(v.x, v.y, v.z).asDiagonal() * q.transpose();
      all.push_back({a(0, 0), a(1, 1), a(2, 2), a(0, 1), a(0, 2), a(1, 2)});
    }
  }
  return all;
}

TEST(SymmetricEigen, AgreesWithEigen) {
  for (const SymmetricMatrix& m : matrices()) {
    Eigen::Matrix3d a;
    a << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
    const Eigen::Vector3d expected = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(a).eigenvalues();
    const double size = expected.cwiseAbs().maxCoeff();
    const SymmetricEigen found = eigenOf(m);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found.values[k], expected[2 - k], 2e-8 * size);
  }
}

TEST(SymmetricEigen, VectorsAreOrthonormalAndGiveTheMatrixBack) {
  for (const SymmetricMatrix& m : matrices()) {
    const SymmetricEigen found = eigenOf(m);
    SymmetricMatrix again;
    for (int k = 0; k < 3; ++k) {
      again.addProduct(found.values[k], found.vectors[k]);
      for (int l = 0; l < 3; ++l) EXPECT_NEAR(dot(found.vectors[k], found.vectors[l]), k == l ? 1 : 0, 1e-12);
    }
    const double size = std::max({std::abs(found.values.x), std::abs(found.values.z)});
    for (const auto entry : {&SymmetricMatrix::xx, &SymmetricMatrix::yy, &SymmetricMatrix::zz,
                             &SymmetricMatrix::xy, &SymmetricMatrix::xz, &SymmetricMatrix::yz})
      EXPECT_NEAR(again.*entry, m.*entry, 5e-8 * size);
  }
}

}  // namespace
}  // namespace weir
