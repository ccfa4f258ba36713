#include "nodes/fluid_surface/fluid_surface.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/compute/profiler.h"
#include "framework/graph/memory_estimate.h"

namespace weir {

void FluidSurface::estimate(const SetupContext&, MemoryNeeds& needs) {
  const double n = fluid->maxCount;
  needs.certain += ParticleKernels::memoryFor(n);
  needs.device += ParticleKernels::memoryFor(n) + KernelField::memoryFor(n, kernelRadius, cellSize);
  needs.remedy = [cells = double(cellSize)](double share) {
    return fmt::format("a cell_size of at least {:.2g} spacings", cells / std::cbrt(share));
  };
}

FluidMeshSettings FluidSurface::meshSettings() const {
  return {.cellSize = cellSize,
          .kernelRadius = kernelRadius,
          .smoothing = smoothing,
          .anisotropy = anisotropy,
          .meshSmoothing = meshSmoothing,
          .level = level.get()};
}

void FluidSurface::reset(const SetupContext& context) {
  if (fluid->period.any())
    throw sceneError("a surface is not closed through the faces of a periodic domain yet",
                     "a fluid with \"periodic\": \"none\"");
  mesher_.emplace(context.device, meshSettings(), fluid->material.spacing);
  *surface = {Array<Vec3f>(context.device), Array<Vec3f>(context.device), Array<Vec3i>(context.device)};
}

void FluidSurface::frame(const StepContext& context) {
  if (!isShown_) return;
  const ProfileScope scope(context.device.profiler(), name());
  mesher_->make(fluid->set(), *surface);
}

void FluidSurface::report(NodeReport& report) {
  if (!mesher_) return;
  report.statistics["level"] = static_cast<double>(mesher_->level());
  report.statistics["vertices"] = surface->vertices.size();
  report.statistics["triangles"] = surface->triangles.size();
  report.statistics["grid_blocks"] = mesher_->blocks();
  report.events.push_back({"particles were too far away for the surface's grid", mesher_->leftOut()});
}

}  // namespace weir
