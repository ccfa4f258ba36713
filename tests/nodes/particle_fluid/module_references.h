// Fluid modules in double precision, written from their equations alone; they work on a ReferenceFluid at its
// present positions.
#pragma once

#include "tests/nodes/particle_fluid/siisph_reference.h"

namespace weir::test {

using Neighbors = std::vector<std::vector<int>>;

struct PbfReference {
  bool textbook = true;
  int iterations = 3;
  double epsilon = 0.01;          ///< in 1/spacing²
  double artificialPressure = 0;  ///< in spacing²
};

/// Predicts, solves by position based fluids, and corrects the velocities.
void stepWithPbf(ReferenceFluid& fluid, const PbfReference& settings);

/// Accelerations by surface tension κ [N] and air pressure [Pa].
std::vector<Vec3d> surfaceTension(const ReferenceFluid& fluid, double coefficient, double airPressure);

/// Velocities after three Jacobi sweeps of the implicit form of XSPH, ν in m/s.
std::vector<Vec3d> implicitXsph(const ReferenceFluid& fluid, double viscosity);

/// ω of every particle, 1/s, and v after confinement of `strength` [1/s] over one step.
std::vector<Vec3d> vorticity(const ReferenceFluid& fluid);
std::vector<Vec3d> confineVorticity(const ReferenceFluid& fluid, double strength);

}  // namespace weir::test
