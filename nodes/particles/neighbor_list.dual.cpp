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

class FindNeighbors {
 public:
  ArrayView<const Vec3f> positions;
  ArrayView<const int> cellStart;
  CellGrid grid;
  float radiusSquared;
  int capacity;
  int shift;
  int* entries;
  int* counts;
  int* truncated;

  /// Straight into the list.
  WEIR_HD void operator()(std::int64_t i) const { counts[i] = find(i, Scratch{listOf(i), 1 << shift}); }

  /// By way of scratch memory, from which neighbouring threads write whole lines.
  WEIR_HD void operator()(std::int64_t i, const Scratch& scratch) const {
    const int count = find(i, scratch);
    int* list = listOf(i);
    for (int k = 0; k < count; ++k) list[k << shift] = scratch[k];
    counts[i] = count;
  }

 private:
  WEIR_HD int* listOf(std::int64_t i) const {
    return entries + NeighborView{nullptr, nullptr, capacity, shift}.first(i);
  }

  WEIR_HD int find(std::int64_t i, const Scratch& list) const {
    const Vec3f p = positions[i];
    const Vec3i cell = grid.cellOf(p);
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
    if (found <= capacity) return found;
    atomicAdd(truncated, 1);
    return capacity;
  }

  WEIR_HD void scan(std::int64_t i, const Vec3f& p, int begin, int end, const Scratch& list,
                    int& found) const {
#ifdef __CUDA_ARCH__
#pragma unroll 4  // so that several positions are under way at once
#endif
    for (int j = begin; j < end; ++j) {
      const Vec3f d = positions[j] - p;
      if (dot(d, d) >= radiusSquared || j == i) continue;
      if (found < capacity) list[found] = j;
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
               particles.counter());
    particles.permute(sort_.order());
  }
  const ProfileScope scope(device.profiler(), "list");
  const std::int64_t lanes = std::int64_t{1} << shift_;
  const std::int64_t padded = (particles.positions().size() + lanes - 1) / lanes * lanes;
  counts_.resize(padded);
  entries_.resize(padded * capacity_);
  const FindNeighbors find{particles.positions().view(),
                           sort_.start(),
                           grid_,
                           radius_ * radius_,
                           capacity_,
                           shift_,
                           entries_.data(),
                           counts_.data(),
                           events};
  constexpr std::string_view kName = "find neighbours";
  // Lists that are not interleaved are written whole anyway.
  if (shift_ > 0 && capacity_ <= kMostScratch)
    parallelForWithScratch(device, kName, particles.count(), capacity_, find);
  else
    parallelFor(device, kName, particles.count(), find);
}

template void NeighborList::buildOn(ThisBackend&, ParticleSet&, const Aabb&, ArrayView<const SinkPiece>);

}  // namespace weir
