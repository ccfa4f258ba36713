#include "tests/nodes/particle_fluid/siisph_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

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

double ReferenceFluid::bulkEnergyDerivative(double lambda) const {
  double sum = 0;
  for (std::size_t k = 1; k <= energy.size(); ++k)
    sum += energy[k - 1] * (std::pow(std::max(lambda, 1.0), double(k)) - 1);
  return sum;
}

double ReferenceFluid::bulkEnergy(double lambda) const {
  const double l = std::max(lambda, 1.0);
  double sum = 0;
  for (std::size_t k = 1; k <= energy.size(); ++k)
    sum += energy[k - 1] * ((std::pow(l, double(k + 1)) - 1) / double(k + 1) - l + 1);
  return sum;
}

double ReferenceFluid::objective(const std::vector<Vec3d>& predicted) const {
  const std::vector<double> lambda = relativeDensities();
  double sum = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3d u = positions[i] - predicted[i];
    sum += 0.5 * dot(u, u) + stiffness() * bulkEnergy(lambda[i]);
  }
  return sum;
}

void ReferenceFluid::solve(const std::vector<std::vector<int>>& lists) {
  const std::vector<Vec3d> predicted = positions;
  const double volume = std::pow(spacing, 3);
  double negativePart = 0;
  for (const double c : energy) negativePart += c;
  std::vector<Wall> walls(positions.size());
  for (std::size_t i = 0; wall && i < positions.size(); ++i) {
    const Wall w = wall(positions[i]);
    const double s = calibration();
    walls[i] = {s * w.phi, s * w.gradient, s * w.d};
  }
  std::vector<Vec3d> byWalls(positions.size());
  for (int k = 0; k < iterations; ++k) {
    std::vector<double> lambda;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      double sum = kernel(0);
      for (const int j : lists[i]) sum += kernel(length(positions[j] - positions[i]));
      const Wall& w = walls[i];
      lambda.push_back(volume * sum + std::max(0.0, w.phi + dot(w.gradient, positions[i] - predicted[i])));
    }
    std::vector<Vec3d> steps;
    std::vector<double> objectives, slopes;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      Vec3d descent = predicted[i] - positions[i];
      double divisor = 1;
      for (const int j : lists[i]) {
        const Vec3d d = positions[j] - positions[i];
        const double a = dt * dt / restDensity * mu * slope(length(d)) / length(d);
        descent -=
            (bulkEnergyDerivative(lambda[i]) + (conservative ? bulkEnergyDerivative(lambda[j]) : 0)) * a * d;
        divisor += (conservative ? 2 : 1) * negativePart * a;
      }
      const Vec3d byWall = -bulkEnergyDerivative(lambda[i]) * stiffness() * walls[i].gradient;
      descent += byWall;
      divisor += negativePart * stiffness() * walls[i].d;
      byWalls[i] += (byWall - byWalls[i]) / divisor;
      const Vec3d u = positions[i] - predicted[i];
      steps.push_back(descent / divisor);
      objectives.push_back(0.5 * dot(u, u) + stiffness() * bulkEnergy(lambda[i]));
      slopes.push_back(dot(descent, descent) / divisor);
    }
    const double allObjectives = std::accumulate(objectives.begin(), objectives.end(), 0.0);
    const double allSlopes = std::accumulate(slopes.begin(), slopes.end(), 0.0);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      double alpha = 1;
      if (stepLength == StepLength::kParticle && objectives[i] < slopes[i]) alpha = objectives[i] / slopes[i];
      if (stepLength == StepLength::kGlobal && allObjectives < allSlopes) alpha = allObjectives / allSlopes;
      positions[i] += alpha * steps[i];
    }
  }
  wallImpulse = {};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    velocities[i] += (positions[i] - predicted[i]) / dt;
    wallImpulse += restDensity * volume / dt * byWalls[i];
  }
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
