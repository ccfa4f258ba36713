#include "nodes/white_water/fluid_grid.h"

#include <algorithm>

#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"

namespace weir {

namespace {

constexpr std::int64_t kMaxCells = std::int64_t{1} << 23;

std::int64_t cellsFor(std::int64_t particles) {
  constexpr std::int64_t kFewest = 1 << 12;
  return std::clamp(2 * particles, kFewest, kMaxCells);
}

}  // namespace

double FluidGrid::memoryFor(double particles) {
  const double cells = std::min(2 * particles + (1 << 12), static_cast<double>(kMaxCells));
  return CellSort::kPerParticle * bytesOfArray(particles, sizeof(int)) + bytesOfArray(cells, sizeof(int)) +
         bytesOfArray(particles, sizeof(Vec4f)) + bytesOfArray(particles, sizeof(Vec3f));
}

Aabb FluidGrid::boxOf(const Particles& fluid) {
  if (fluid.set().bound() == 0) return {};
  dispatch(fluid.set().device(), [&](auto& device) { findBoxOn(device, fluid); });
  return box_.toHost().front();
}

void FluidGrid::fit(const Particles& fluid) {
  radius_ = kNearRadius * fluid.material.spacing;
  fittedFor_ = fluid.set().bound();
  grid_ = chooseCellGrid(boxOf(fluid), radius_, cellsFor(fittedFor_));
}

FluidGridView FluidGrid::view() const {
  return {.grid = grid_,
          .radius = radius_,
          .start = sorted_.start(),
          .places = places_.view(),
          .velocities = velocities_.view()};
}

}  // namespace weir
