// One step of semi-implicit incompressible SPH in double precision, over all pairs: slow, obvious, and
// written from the equations alone. The oracle of the fast one.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "framework/base/vec.h"

namespace weir::test {

struct ReferenceFluid {
  double spacing = 0.01, supportRatio = 1.2, restDensity = 1000, mu = 1;
  double dt = 1e-3;
  int iterations = 3;
  bool conservative = true;
  std::vector<double> energy{1};  ///< c_k of Ḃ(λ) = Σ c_k·(λ^k − 1), from c_1
  enum class StepLength { kFull, kParticle, kGlobal } stepLength = StepLength::kFull;
  double xsph = 0;
  Vec3d gravity{0, -9.8, 0};

  std::vector<Vec3d> positions, velocities;

  /// Integrals of the kernel with s = 1 over solids: Φ, ∇Φ and D at a point; none by default.
  struct Wall {
    double phi = 0;
    Vec3d gradient;
    double d = 0;
  };
  std::function<Wall(const Vec3d&)> wall;
  /// What walls gave the fluid in the last step, N·s.
  Vec3d wallImpulse;

  void step();
  /// λ of every particle at the current positions.
  std::vector<double> relativeDensities() const;
  /// The function that a step minimises, Eq. 7 times dt²/m, with λ clamped below at 1.
  double objective(const std::vector<Vec3d>& predicted) const;

  // The parts of a step, for the references of other modules.
  double radius() const { return supportRatio * spacing; }
  double volume() const { return spacing * spacing * spacing; }
  double kernel(double r) const;
  double slope(double r) const;  ///< |W'|
  void predict();
  std::vector<std::vector<int>> neighbors() const;

 private:
  double calibration() const;
  double bulkEnergy(double lambda) const;
  double bulkEnergyDerivative(double lambda) const;
  double stiffness() const { return dt * dt / restDensity * mu / volume(); }  ///< (c·dt)²
  void solve(const std::vector<std::vector<int>>& neighbors);
  void smooth(const std::vector<std::vector<int>>& neighbors);
};

}  // namespace weir::test
