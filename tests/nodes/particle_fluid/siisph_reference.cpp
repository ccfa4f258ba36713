#include "tests/nodes/particle_fluid/siisph_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weir::test {

// s = 1 / Σ V0·W₁ over the cubic lattice.
double ReferenceFluid::calibration() const {
  const double H = radius();
  double sum = 0;
  for (int x = -4; x <= 4; ++x)
    for (int y = -4; y <= 4; ++y)
      for (int z = -4; z <= 4; ++z) {
        const double r = spacing * std::sqrt(double(x * x + y * y + z * z));
        if (r < H) sum += std::pow(spacing, 3) * 15 / (std::numbers::pi * H * H * H) * std::pow(1 - r / H, 3);
      }
  return 1 / sum;
}

double ReferenceFluid::kernel(double r) const {
  const double H = radius();
  return r < H ? calibration() * 15 / (std::numbers::pi * H * H * H) * std::pow(1 - r / H, 3) : 0;
}

double ReferenceFluid::slope(double r) const {
  const double H = radius();
  return r < H ? calibration() * 45 / (std::numbers::pi * std::pow(H, 4)) * std::pow(1 - r / H, 2) : 0;
}

std::vector<std::vector<int>> ReferenceFluid::neighbors() const {
  const int n = static_cast<int>(positions.size());
  std::vector<std::vector<int>> lists(positions.size());
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (i != j && length(positions[j] - positions[i]) < radius()) lists[i].push_back(j);
  return lists;
}

std::vector<double> ReferenceFluid::relativeDensities() const {
  std::vector<double> lambda;
  for (const Vec3d& a : positions) {
    double sum = 0;
    for (const Vec3d& b : positions)
      if (const double r = length(b - a); r < radius()) sum += kernel(r);
    lambda.push_back(std::pow(spacing, 3) * sum);
  }
  return lambda;
}

void ReferenceFluid::solve(const std::vector<std::vector<int>>& lists) {
  const std::vector<Vec3d> predicted = positions;
  const double volume = std::pow(spacing, 3);
  for (int k = 0; k < iterations; ++k) {
    std::vector<double> derivative;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      double sum = kernel(0);
      for (const int j : lists[i]) sum += kernel(length(positions[j] - positions[i]));
      derivative.push_back(std::max(volume * sum, 1.0) - 1);
    }
    std::vector<Vec3d> next = positions;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      Vec3d numerator = predicted[i] - positions[i];
      double divisor = 1;
      for (const int j : lists[i]) {
        const Vec3d d = positions[j] - positions[i];
        const double a = dt * dt / restDensity * mu * slope(length(d)) / length(d);
        numerator -= (derivative[i] + (conservative ? derivative[j] : 0)) * a * d;
        divisor += (conservative ? 2 : 1) * a;
      }
      next[i] = positions[i] + numerator / divisor;
    }
    positions = next;
  }
  for (std::size_t i = 0; i < positions.size(); ++i) velocities[i] += (positions[i] - predicted[i]) / dt;
}

void ReferenceFluid::smooth(const std::vector<std::vector<int>>& lists) {
  std::vector<Vec3d> next = velocities;
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (const int j : lists[i])
      next[i] += xsph * std::pow(spacing, 3) * kernel(length(positions[j] - positions[i])) *
                 (velocities[j] - velocities[i]);
  velocities = next;
}

void ReferenceFluid::predict() {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    velocities[i] += dt * gravity;
    positions[i] += dt * velocities[i];
  }
}

void ReferenceFluid::step() {
  predict();
  const auto lists = neighbors();
  solve(lists);
  if (xsph > 0) smooth(lists);
}

}  // namespace weir::test
