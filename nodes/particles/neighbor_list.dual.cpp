#include "nodes/particles/neighbor_list.h"

namespace weir {

namespace {

/// The cell of a particle, or -1 if it is to be removed.
struct CellKey {
  ArrayView<const Vec3f> positions, velocities;
  CellGrid grid;
  Aabb domain;
  ArrayView<const SinkPiece> sinks;
  int* escaped;
  int* nonFinite;

  WEIR_HD int operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    if (!isFinite(p) || !isFinite(velocities[i])) {
      atomicAdd(nonFinite, 1);
      return -1;
    }
    if (!domain.contains(p)) {
      atomicAdd(escaped, 1);
      return -1;
    }
    if (removedBySinks(sinks, p)) return -1;
    return grid.index(grid.cellOf(p));
  }
};

struct FindNeighbors {
  ArrayView<const Vec3f> positions;
  ArrayView<const int> cellStart;
  CellGrid grid;
  float radiusSquared;
  int capacity;
  int shift;
  int* entries;
  int* counts;
  int* truncated;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    const Vec3i cell = grid.cellOf(p);
    const NeighborView layout{nullptr, nullptr, capacity, shift};
    int* list = entries + layout.first(i);
    int found = 0;
    for (int dz = -1; dz <= 1; ++dz) {
      const int z = CellGrid::step(cell.z, dz, grid.cells.z);
      for (int dy = -1; dy <= 1; ++dy) {
        const int y = CellGrid::step(cell.y, dy, grid.cells.y);
        const int row = (z * grid.cells.y + y) * grid.cells.x;
        if (cell.x > 0 && cell.x + 1 < grid.cells.x) {
          // The three cells of a row stand side by side.
          scan(i, p, cellStart[row + cell.x - 1], cellStart[row + cell.x + 2], list, found);
        } else {
          for (int dx = -1; dx <= 1; ++dx) {
            const int c = row + CellGrid::step(cell.x, dx, grid.cells.x);
            scan(i, p, cellStart[c], cellStart[c + 1], list, found);
          }
        }
      }
    }
    if (found > capacity) {
      atomicAdd(truncated, 1);
      found = capacity;
    }
    counts[i] = found;
  }

  WEIR_HD void scan(std::int64_t i, const Vec3f& p, int begin, int end, int* list, int& found) const {
    for (int j = begin; j < end; ++j) {
      const Vec3f d = positions[j] - p;
      if (dot(d, d) >= radiusSquared || j == i) continue;
      if (found < capacity) list[static_cast<std::int64_t>(found) << shift] = j;
      ++found;
    }
  }
};

}  // namespace

template <class Backend>
void NeighborList::buildOn(Backend& device, ParticleSet& particles, const Aabb& domain,
                           ArrayView<const SinkPiece> sinks) {
  int* events = events_.data();
  {
    const ProfileScope scope(device.profiler(), "sort");
    sort_.sort(device, particles.count(), grid_.cellCount(),
               CellKey{particles.positions().view(), particles.velocities().view(), grid_, domain, sinks,
                       events + 1, events + 2},
               kept_.data());
    device.copy(particles.counter(), kept_.data(), sizeof(int));
    particles.permute(sort_.order());
  }
  const ProfileScope scope(device.profiler(), "list");
  const std::int64_t lanes = std::int64_t{1} << shift_;
  const std::int64_t padded = (particles.positions().size() + lanes - 1) / lanes * lanes;
  counts_.resize(padded);
  entries_.resize(padded * capacity_);
  parallelFor(device, "find neighbours", particles.count(),
              FindNeighbors{particles.positions().view(), sort_.start(), grid_, radius_ * radius_, capacity_,
                            shift_, entries_.data(), counts_.data(), events});
}

template void NeighborList::buildOn(ThisBackend&, ParticleSet&, const Aabb&, ArrayView<const SinkPiece>);

}  // namespace weir
