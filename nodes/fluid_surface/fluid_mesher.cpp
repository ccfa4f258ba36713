#include "nodes/fluid_surface/fluid_mesher.h"

#include "nodes/fluid_surface/surface_level.h"

namespace weir {

FluidMesher::FluidMesher(Device& device, const FluidMeshSettings& settings, float spacing)
    : device_(device),
      kernels_(device),
      field_(device),
      cubes_(device),
      smoother_(device),
      spray_(device),
      settings_{.spacing = spacing,
                .radius = settings.kernelRadius * spacing,
                .smoothing = settings.smoothing,
                .anisotropy = settings.anisotropy,
                .leavesSpray = settings.leavesSpray},
      meshSmoothing_(settings.meshSmoothing),
      cell_(settings.cellSize * spacing),
      level_(settings.level ? *settings.level : flatLevel(device, settings_)) {
  settings_.loneAxis = loneAxis(level_, settings_);
}

void FluidMesher::make(ParticleSet& particles, DynamicMesh& mesh) {
  const std::int64_t count = particles.refreshCount();
  kernels_.make(device_, particles.positions().read(), count, settings_,
                KernelField::farthest(cell_, settings_.radius));
  leftOut_ = count - kernels_.size();
  field_.make(device_, kernels_, cell_);
  cubes_.extract(device_, field_.grid(), level_, mesh);
  smoother_.smooth(device_, mesh, meshSmoothing_);
  if (settings_.leavesSpray) spray_.make(device_, kernels_, particles, settings_.spacing);
}

}  // namespace weir
