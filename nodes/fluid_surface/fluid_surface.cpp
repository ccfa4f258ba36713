#include "nodes/fluid_surface/fluid_surface.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/compute/profiler.h"
#include "framework/graph/memory_estimate.h"
#include "nodes/fluid_surface/surface_level.h"

namespace weir {

void FluidSurface::estimate(const SetupContext&, MemoryNeeds& needs) {
  const double n = fluid->maxCount;
  needs.certain += ParticleKernels::memoryFor(n);
  needs.device += ParticleKernels::memoryFor(n) + KernelField::memoryFor(n, kernelRadius, cellSize);
  needs.remedy = [cells = double(cellSize)](double share) {
    return fmt::format("a cell_size of at least {:.2g} spacings", cells / std::cbrt(share));
  };
}

void FluidSurface::reset(const SetupContext& context) {
  State& state = state_.emplace(context.device);
  const float d = fluid->material.spacing;
  state.settings = {
      .spacing = d, .radius = kernelRadius * d, .smoothing = smoothing, .anisotropy = anisotropy};
  state.cell = cellSize * d;
  state.level = level.get() ? *level.get() : flatLevel(context.device, state.settings);
  state.settings.loneAxis = loneAxis(state.level, state.settings);
  *surface = {Array<Vec3f>(context.device), Array<Vec3f>(context.device), Array<Vec3i>(context.device)};
}

void FluidSurface::frame(const StepContext& context) {
  State& state = *state_;
  const ProfileScope scope(context.device.profiler(), name());
  ParticleSet& particles = fluid->set();
  const std::int64_t count = particles.refreshCount();
  state.kernels.make(context.device, particles.positions().read(), count, state.settings,
                     KernelField::farthest(state.cell, state.settings.radius));
  state.leftOut = count - state.kernels.size();
  state.field.make(context.device, state.kernels, state.cell);
  state.cubes.extract(context.device, state.field.grid(), state.level, *surface);
  state.smoother.smooth(context.device, *surface, meshSmoothing);
}

void FluidSurface::report(NodeReport& report) {
  if (!state_) return;
  report.statistics["level"] = static_cast<double>(state_->level);
  report.statistics["vertices"] = surface->vertices.size();
  report.statistics["triangles"] = surface->triangles.size();
  report.statistics["grid_blocks"] = state_->field.grid().blocks();
  report.events.push_back({"particles were too far away for the surface's grid", state_->leftOut});
}

}  // namespace weir
