#include "nodes/fluid_surface/kernel_field.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "framework/base/error.h"
#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"

namespace weir {

namespace {

constexpr std::int64_t kMaxNodes = std::numeric_limits<int>::max();

[[noreturn]] void tooFine(float cellSize) {
  throw simulationError(fmt::format("the surface of the fluid needs a grid of more than {} nodes of {:g} m",
                                    kMaxNodes, cellSize),
                        {}, "use a larger cell_size");
}

}  // namespace

float KernelField::farthest(float cellSize, float kernelRadius) {
  // Twice the radius is more than any kernel reaches with its node and block rounded.
  return cellSize * BlockKey::kSide * static_cast<float>(BlockKey::kFarthest) - 4 * kernelRadius;
}

double KernelField::memoryFor(double particles, double kernelRadius, double cellSize) {
  const double side = cellSize * BlockKey::kSide;  // of a block
  const double pairs = particles * std::pow(1 + (2 * kernelRadius + cellSize) / side, 3);
  // Half of all blocks are at the surface, where they are half full.
  const double blocks = 1.5 * particles / std::pow(side, 3);
  constexpr int kNumbersOfNode = 3;  // the value, and what is counted for the mesh
  // The sort by block works in two sets of pairs.
  return bytesOfArray(particles, sizeof(int)) +
         2 * (bytesOfArray(pairs, sizeof(std::uint64_t)) + bytesOfArray(pairs, sizeof(int))) +
         bytesOfArray(pairs, sizeof(int)) +
         kNumbersOfNode * bytesOfArray(blocks * BlockKey::kNodes, sizeof(float)) +
         bytesOfArray(blocks * GridView::kAround, sizeof(int));
}

void KernelField::make(Device& onDevice, const ParticleKernels& kernels, float cellSize) {
  grid_.resize(cellSize, 0);
  const std::int64_t n = kernels.size();
  if (n == 0) return;
  counts_.resizeDiscarding(n);
  dispatch(onDevice, [&](auto& device) { countOn(device, kernels, cellSize); });
  const std::int64_t pairs = pairCount_.toHost().front();
  if (pairs > kMaxNodes) tooFine(cellSize);
  dispatch(onDevice, [&](auto& device) { listOn(device, kernels, cellSize, pairs); });
  const std::int64_t blocks = headCount_.toHost().front();
  if (blocks > kMaxNodes / BlockKey::kNodes) tooFine(cellSize);
  grid_.resize(cellSize, blocks);
  dispatch(onDevice, [&](auto& device) { sumOn(device, kernels, pairs); });
  grid_.connect(onDevice);
}

}  // namespace weir
