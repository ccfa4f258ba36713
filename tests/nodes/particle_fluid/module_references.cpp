#include "tests/nodes/particle_fluid/module_references.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weir::test {

namespace {

/// ∇_i W(x_i − x_j), 1/m⁴.
Vec3d kernelGradient(const ReferenceFluid& fluid, std::size_t i, int j) {
  const Vec3d d = fluid.positions[i] - fluid.positions[static_cast<std::size_t>(j)];
  return -fluid.slope(length(d)) * normalized(d);
}

double textbookMultiplier(double lambda, const std::vector<Vec3d>& gradients, double volume, double epsilon) {
  double sum = epsilon;
  Vec3d own{};
  for (const Vec3d& gradient : gradients) {
    sum += dot(volume * gradient, volume * gradient);
    own += volume * gradient;
  }
  return -std::max(lambda - 1, 0.0) / (sum + dot(own, own));
}

double unnormalizedMultiplier(double density, double restDensity, const std::vector<Vec3d>& gradients) {
  double sum = 0.1;
  Vec3d own{};
  for (const Vec3d& gradient : gradients) {
    sum += dot(gradient, gradient);
    own += gradient;
  }
  return -std::max(density - restDensity, 0.0) / (sum + dot(own, own));
}

void iteratePbf(ReferenceFluid& fluid, const PbfReference& settings, const Neighbors& lists) {
  const double area = fluid.spacing * fluid.spacing, volume = fluid.volume();
  std::vector<std::vector<Vec3d>> gradients(lists.size());
  std::vector<double> multipliers;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    double sum = fluid.kernel(0);
    for (const int j : lists[i]) {
      gradients[i].push_back(kernelGradient(fluid, i, j));
      sum += fluid.kernel(length(fluid.positions[i] - fluid.positions[static_cast<std::size_t>(j)]));
    }
    multipliers.push_back(
        settings.textbook
            ? textbookMultiplier(volume * sum, gradients[i], volume, settings.epsilon / area)
            : unnormalizedMultiplier(fluid.restDensity * volume * sum, fluid.restDensity, gradients[i]));
  }
  std::vector<Vec3d> next = fluid.positions;
  for (std::size_t i = 0; i < lists.size(); ++i)
    for (std::size_t k = 0; k < lists[i].size(); ++k) {
      const auto j = static_cast<std::size_t>(lists[i][k]);
      const double both = multipliers[i] + multipliers[j];
      if (!settings.textbook) {
        next[i] += 10 * both * gradients[i][k];
        continue;
      }
      const double ratio =
          fluid.kernel(length(fluid.positions[i] - fluid.positions[j])) / fluid.kernel(0.2 * fluid.radius());
      const double repulsion = -settings.artificialPressure * area * std::pow(ratio, 4);
      next[i] += (both + repulsion) * volume * gradients[i][k];
    }
  fluid.positions = next;
}

double poly6(double r, double H) {
  return r < H ? 315 / (64 * std::numbers::pi * std::pow(H, 9)) * std::pow(H * H - r * r, 3) : 0;
}

/// dW/dr
double poly6Derivative(double r, double H) {
  return r < H ? -6 * r * 315 / (64 * std::numbers::pi * std::pow(H, 9)) * std::pow(H * H - r * r, 2) : 0;
}

}  // namespace

void stepWithPbf(ReferenceFluid& fluid, const PbfReference& settings) {
  fluid.predict();
  const std::vector<Vec3d> predicted = fluid.positions;
  const Neighbors lists = fluid.neighbors();
  for (int k = 0; k < settings.iterations; ++k) iteratePbf(fluid, settings, lists);
  for (std::size_t i = 0; i < predicted.size(); ++i)
    fluid.velocities[i] += (fluid.positions[i] - predicted[i]) / fluid.dt;
}

std::vector<Vec3d> surfaceTension(const ReferenceFluid& fluid, double coefficient, double airPressure) {
  const double H = fluid.radius(), volume = fluid.volume();
  const std::vector<Vec3d>& x = fluid.positions;
  const auto gradient = [&](std::size_t i, std::size_t j) {
    return poly6Derivative(length(x[i] - x[j]), H) * normalized(x[i] - x[j]);
  };
  std::vector<double> color, gradientSquared;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < x.size(); ++j) sum += volume * poly6(length(x[i] - x[j]), H);
    color.push_back(sum);
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    Vec3d sum{};
    for (std::size_t j = 0; j < x.size(); ++j) sum += volume * color[j] / color[i] * gradient(i, j);
    gradientSquared.push_back(dot(sum, sum));
  }
  std::vector<Vec3d> accelerations(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < x.size(); ++j) {
      const double stress = coefficient / 4 * (gradientSquared[i] + gradientSquared[j]) + airPressure;
      accelerations[i] += volume / fluid.restDensity * stress * gradient(i, j);
    }
  return accelerations;
}

std::vector<Vec3d> implicitXsph(const ReferenceFluid& fluid, double viscosity) {
  const double b = fluid.dt * viscosity / fluid.radius();
  const Neighbors lists = fluid.neighbors();
  std::vector<Vec3d> velocities = fluid.velocities;
  for (int sweep = 0; sweep < 3; ++sweep) {
    std::vector<Vec3d> next = fluid.velocities;
    for (std::size_t i = 0; i < lists.size(); ++i) {
      Vec3d sum{};
      double weights = 0;
      for (const int j : lists[i]) {
        const auto other = static_cast<std::size_t>(j);
        const double w = fluid.kernel(length(fluid.positions[i] - fluid.positions[other]));
        sum += w * velocities[other];
        weights += w;
      }
      if (weights > 0) next[i] = (fluid.velocities[i] + b * (sum / weights)) / (1 + b);
    }
    velocities = next;
  }
  return velocities;
}

namespace {

/// N of particle i; its derivatives of fields are divided by it.
double derivativeNorm(const ReferenceFluid& fluid, std::size_t i, const std::vector<int>& neighbors) {
  double sum = 0;
  for (const int j : neighbors) {
    const double r = length(fluid.positions[static_cast<std::size_t>(j)] - fluid.positions[i]);
    sum += fluid.slope(r) * r / 3;
  }
  return sum;
}

}  // namespace

std::vector<Vec3d> vorticity(const ReferenceFluid& fluid) {
  const Neighbors lists = fluid.neighbors();
  std::vector<Vec3d> all(lists.size());
  for (std::size_t i = 0; i < lists.size(); ++i)
    for (const int j : lists[i]) {
      const auto other = static_cast<std::size_t>(j);
      // v_ij × ∇_j W with v_ij = v_j − v_i, as published, but for N.
      const Vec3d relative = fluid.velocities[other] - fluid.velocities[i];
      all[i] += cross(relative, kernelGradient(fluid, other, static_cast<int>(i))) /
                derivativeNorm(fluid, i, lists[i]);
    }
  return all;
}

std::vector<Vec3d> confineVorticity(const ReferenceFluid& fluid, double strength) {
  const Neighbors lists = fluid.neighbors();
  const std::vector<Vec3d> omega = vorticity(fluid);
  std::vector<Vec3d> velocities = fluid.velocities;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    Vec3d eta{};
    for (const int j : lists[i])
      eta += (length(omega[static_cast<std::size_t>(j)]) - length(omega[i])) * kernelGradient(fluid, i, j) /
             derivativeNorm(fluid, i, lists[i]);
    const double min = 0.01 * length(omega[i]) / fluid.spacing;
    velocities[i] += fluid.dt * strength * fluid.spacing * cross(eta / (length(eta) + min), omega[i]);
  }
  return velocities;
}

}  // namespace weir::test
