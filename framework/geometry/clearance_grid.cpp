#include "framework/geometry/clearance_grid.h"

#include <algorithm>
#include <cmath>

#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"

namespace weir {

namespace {

/// Counts of cells of this edge, in double because they may not fit into an int.
Vec3d cellsOf(const Vec3f& size, double edge) {
  const auto along = [edge](float length) { return std::max(1.0, std::ceil(length / edge)); };
  return {along(size.x), along(size.y), along(size.z)};
}

}  // namespace

ClearanceGrid::ClearanceGrid(Device& device, const TriangleTreeView& tree, float finest) {
  WEIR_CHECK(finest > 0);
  if (tree.empty()) return;
  bounds_ = tree.bounds;
  double edge = finest;
  Vec3d counts = cellsOf(bounds_.size(), edge);
  while (counts.x * counts.y * counts.z > double(kMaxCells)) {
    edge *= 1.05;
    counts = cellsOf(bounds_.size(), edge);
  }
  cell_ = static_cast<float>(edge);
  cells_ = {static_cast<int>(counts.x), static_cast<int>(counts.y), static_cast<int>(counts.z)};
  steps_ = Array<std::uint8_t>(device, std::int64_t{cells_.x} * cells_.y * cells_.z);
  dispatch(device, [&](auto& backend) { fillOn(backend, tree); });
}

double ClearanceGrid::maxMemoryFor(const Vec3f& size, float finest) {
  const Vec3d counts = cellsOf(size, finest);
  if (!(counts.x * counts.y * counts.z < double(kMaxCells))) return kMaxMemory;
  const auto coarser = [&](double by) {
    return std::ceil(counts.x / by) * std::ceil(counts.y / by) * std::ceil(counts.z / by);
  };
  return bytesOfArray(coarser(1), sizeof(std::uint8_t)) + bytesOfArray(coarser(2), sizeof(float)) +
         bytesOfArray(coarser(4), sizeof(float));
}

ClearanceView ClearanceGrid::view() const {
  return {bounds_, cell_, 1 / cell_, step_, cells_, steps_.view()};
}

}  // namespace weir
