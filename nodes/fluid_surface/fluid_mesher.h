// Makes the mesh of a fluid's surface from its particles: what a FluidSurface does, for others as well.
#pragma once

#include <cstdint>
#include <optional>

#include "framework/base/api.h"
#include "framework/geometry/dynamic_mesh.h"
#include "framework/particles/particle_set.h"
#include "nodes/fluid_surface/kernel_field.h"
#include "nodes/fluid_surface/marching_cubes.h"
#include "nodes/fluid_surface/mesh_smoother.h"
#include "nodes/fluid_surface/spray.h"

namespace WEIR_API weir {

/// As the parameters of a FluidSurface; lengths in particle spacings.
struct FluidMeshSettings {
  float cellSize = 0.5f;
  float kernelRadius = 2.5f;
  float smoothing = 0.9f;
  float anisotropy = 4;
  int meshSmoothing = 0;
  std::optional<float> level;  ///< none: a flat surface is half a spacing outside of the particles
  bool leavesSpray = false;    ///< what is not full fluid is no part of the mesh, but becomes drops
};

class FluidMesher {
 public:
  /// For particles of this spacing (m, above 0). Waits for the device, which must outlive it.
  FluidMesher(Device& device, const FluidMeshSettings& settings, float spacing);

  /// Replaces the mesh, whose arrays are of the same device. Throws a simulation Error where the grid or the
  /// mesh would be too large. Waits for the device.
  void make(ParticleSet& particles, DynamicMesh& mesh);

  /// The field's value at the surface.
  float level() const { return level_; }
  /// Of the last particles, if that is left out; else none.
  const Spray& spray() const { return spray_; }
  /// Of the last mesh: particles that were too far away, and blocks of the grid.
  std::int64_t leftOut() const { return leftOut_; }
  std::int64_t blocks() const { return field_.grid().blocks(); }

 private:
  Device& device_;
  ParticleKernels kernels_;
  KernelField field_;
  MarchingCubes cubes_;
  MeshSmoother smoother_;
  Spray spray_;
  KernelSettings settings_;
  int meshSmoothing_;
  float cell_;   // m
  float level_;  // at which the surface is
  std::int64_t leftOut_ = 0;
};

}  // namespace weir
