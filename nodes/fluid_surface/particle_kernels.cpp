#include "nodes/fluid_surface/particle_kernels.h"

#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"

namespace weir {

double ParticleKernels::memoryFor(double particles) {
  return CellSort::kPerParticle * bytesOfArray(particles, sizeof(int)) +
         bytesOfArray(3 * particles, sizeof(float)) + bytesOfArray(particles, sizeof(ParticleKernel));
}

void ParticleKernels::make(Device& onDevice, ArrayView<const Vec3f> positions, std::int64_t count,
                           const KernelSettings& settings, float farthest) {
  size_ = 0;
  if (count == 0) return;
  dispatch(onDevice, [&](auto& device) { boundOn(device, positions, count, farthest); });
  constexpr std::int64_t kMinCells = 1 << 12;
  const CellGrid grid =
      chooseCellGrid(box_.toHost().front(), settings.radius, std::max<std::int64_t>(kMinCells, count));
  dispatch(onDevice, [&](auto& device) { sortOn(device, positions, count, grid, farthest); });
  size_ = kept_.toHost().front();
  kernels_.resizeDiscarding(size_);
  spray_.resizeDiscarding(settings.leavesSpray ? size_ : 0);
  dispatch(onDevice, [&](auto& device) { makeOn(device, grid, count, settings); });
}

}  // namespace weir
