// Particles and meshes that Python gives as arrays, in place of the files that nodes read.
//
// The arrays come checked, from weir/_arrays.py: finite, contiguous, and as long as each other.
#pragma once

#include <nanobind/nanobind.h>

#include <string>
#include <vector>

#include "framework/particles/particle_batch.h"
#include "python/src/python_scene.h"

namespace weir::python {

namespace nb = nanobind;

/// Gives a ParticleFile or a MeshFile what is in `arrays`, by name: for the one `positions`, `velocities` and
/// the dict `attributes`, for the other `vertices` and `faces`. Throws a scene Error for a node of another
/// type.
void giveArrays(Node& node, nb::dict arrays);

/// Particles on their way into a fluid, from the same arrays as those of a ParticleFile.
void fillBatch(ParticleBatch& batch, Device& device, nb::dict arrays);

/// Copies of what a node was given, by the same names; None if it was given nothing.
nb::object givenArrays(const Node& node);

/// The names of all nodes that go by arrays.
std::vector<std::string> nodesWithArrays(const Scene& scene);

}  // namespace weir::python
