// How many bytes a step must move at the least, so that its time can be compared with that of a copy.
#pragma once

namespace weir::app {

/// The passes over the neighbour lists that a step of the fluid makes.
struct StepPasses {
  int iterations = 3;       ///< of the solver: each is a density and an update
  int viscositySweeps = 1;  ///< sweeps of velocities over the neighbours
};

/// Bytes that one step must read and write for each particle, where each array is read and written once in a
/// pass, positions and velocities take 16 bytes, densities and the entries of lists 4, and what one pass
/// leaves in a cache is lost before the next. With n neighbours:
///
///   sort and move         64         positions and velocities, in and out
///   lists                 24 + 4n    positions in, lists and the first density out
///   further densities     20 + 4n    each
///   updates               36 + 4n    each
///   viscosity             48 + 4n    each sweep
///   walls and velocities  80
double minBytesOfStep(const StepPasses& passes, double neighbors);

}  // namespace weir::app
