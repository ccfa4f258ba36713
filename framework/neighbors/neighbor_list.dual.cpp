#include "framework/neighbors/neighbor_list.h"

#include <algorithm>

#include "framework/compute/wide_access.h"
#include "framework/neighbors/cell_rows.h"
#include "framework/neighbors/code_search.h"
#include "framework/neighbors/crowding.h"
#include "framework/neighbors/group_threads.h"
#include "framework/neighbors/halo_order.h"
#include "framework/neighbors/lane_search.h"
#include "framework/neighbors/list_packer.h"
#include "framework/particles/permutation.h"

namespace weir {

namespace {

/// The cell of a particle, or -1 if it is to be removed.
struct CellKey {
  ParticleSet::PendingMotion at;
  CellGrid grid;
  Aabb domain;
  ArrayView<const SinkPiece> sinks;
  int* escaped;
  int* nonFinite;
  int* blocksWanted;  // by the lists to come

  WEIR_HD int operator()(std::int64_t i) const {
    if (i == 0) *blocksWanted = 0;
    const Vec3f v = at.velocity(i), p = at.motion.position(at.positions[i], v);
    if (!isFinite(p) || !isFinite(v)) {
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

/// The cell of a particle of the halo, or -1 for one that is no neighbour of any.
struct HaloKey {
  ArrayView<const Vec3f> positions;
  CellGrid grid;
  std::int64_t first;

  WEIR_HD int operator()(std::int64_t k) const {
    const Vec3f p = positions[first + k];
    return isFinite(p) ? grid.index(grid.cellOf(p)) : -1;
  }
};

/// Fine cells of a halo.
struct FillFine {
  ArrayView<const Vec3f> positions;
  float inverseCellSize;
  std::int64_t first;
  FineCell* fine;

  WEIR_HD void operator()(std::int64_t k) const {
    fine[first + k] = FineCell::of(positions[first + k], inverseCellSize);
  }
};

#ifdef WEIR_HAS_EIGHT

/// The keys of eight particles at once if nothing unusual is to be said of any.
struct WriteKeys {
  CellKey key;
  ArrayView<int> keys;

  void operator()(std::int64_t i) const { keys[i] = key(i); }
  void operator()(Eight i) const {
    if (!areUsual(i)) forEachOf(i, *this);
  }

 private:
  /// Writes the keys if the particles are all to be kept, in the box of the grid or not far from it.
  bool areUsual(Eight i) const {
    if (i.first == 0 || key.sinks.size > 0) return false;  // the first one does more
    const FreeMotion& motion = key.at.motion;
    const Vec3<Lanes> v = moved(read(key.at.velocities, i), motion.acceleration, motion.dt);
    const Vec3<Lanes> p = moved(read(key.at.positions, i), v, motion.dt);
    LaneMask usual = isFiniteEach(p) & isFiniteEach(v) & isWithin(key.domain, p);
    const CellGrid& grid = key.grid;
    const Vec3<Lanes> at = grid.along(p);
    const auto cellOf = [&](const Lanes& place, int first, int cells) {
      const Lanes cell = Lanes::Vector(_mm256_floor_ps((grid.inverseCellSize * place).v));
      const auto low = static_cast<float>(first), size = static_cast<float>(cells);
      usual = usual & !(cell < Lanes(low - size)) & (cell < Lanes(low + 2 * size));
      return __builtin_convertvector(cell.v, LaneInts::Vector) - first;
    };
    const auto wrapped = [&](const Lanes& place, int cells) {
      const LaneInts::Vector c = cellOf(place, 0, cells);
      return c + ((c < 0) & cells) - ((c >= cells) & cells);
    };
    const LaneInts::Vector x = wrapped(at.x, grid.cells.x), y = wrapped(at.y, grid.cells.y);
    LaneInts::Vector z;
    if (grid.slabLayers == 0) {
      z = wrapped(at.z, grid.cells.z);
    } else {
      const int last = grid.slabLayers - 1;
      z = cellOf(at.z, grid.firstLayer, grid.slabLayers);
      z = (z < 0) ? z * 0 : (z > last ? z * 0 + last : z);
    }
    constexpr int kExact = 1 << 22;  // cells, numbers of which are floats
    if (any(!usual) ||
        std::max({grid.cells.x, grid.cells.y, grid.cells.z, std::abs(grid.firstLayer)}) > kExact)
      return false;
    LaneInts{(z * grid.cells.y + y) * grid.cells.x + x}.store(keys.data + i.first);
    return true;
  }

  /// As FreeMotion does it.
  template <class By>
  static Vec3<Lanes> moved(const Vec3<Lanes>& from, const Vec3<By>& by, float dt) {
    return {from.x + Lanes(dt * by.x), from.y + Lanes(dt * by.y), from.z + Lanes(dt * by.z)};
  }
  static LaneMask isWithin(const Aabb& box, const Vec3<Lanes>& p) {
    const auto isBetween = [](const Lanes& at, float low, float high) {
      return !(at < Lanes(low)) & !(at > Lanes(high));
    };
    return isBetween(p.x, box.lo.x, box.hi.x) & isBetween(p.y, box.lo.y, box.hi.y) &
           isBetween(p.z, box.lo.z, box.hi.z);
  }
  static LaneMask isFiniteEach(const Vec3<Lanes>& a) {
    return a.x * 0.0f + a.y * 0.0f + a.z * 0.0f == Lanes(0.0f);
  }
};

/// What has been written.
struct WrittenKey {
  ArrayView<const int> keys;
  int operator()(std::int64_t i) const { return keys[i]; }
};

#endif

/// Calls f(begin, end, layer) for ranges of sorted places that hold all particles near a point, in the layers
/// -1, 0 and 1 of cells from its own.
template <class Rows, class F>
WEIR_HD void forEachRangeNear(const Vec3f& p, const CellGrid& grid, const ArrayView<const int>& cellStart,
                              const Rows& rows, const F& f) {
  const Vec3i cell = grid.cellOf(p);
  const bool inside = cell.x > 0 && cell.x + 1 < grid.cells.x;
  for (int dz = -1; dz <= 1; ++dz) {
    const int z = CellGrid::step(cell.z, dz, grid.cells.z);
    for (int dy = -1; dy <= 1; ++dy) {
      const RowPart part = rows(dy, dz);
      if (part.last < part.first) continue;
      const int y = CellGrid::step(cell.y, dy, grid.cells.y);
      const int row = (z * grid.cells.y + y) * grid.cells.x;
      if (inside) {
        // The cells of a row stand side by side.
        f(cellStart[row + cell.x + part.first], cellStart[row + cell.x + part.last + 1], dz);
      } else {
        for (int dx = part.first; dx <= part.last; ++dx) {
          const int c = row + CellGrid::step(cell.x, dx, grid.cells.x);
          f(cellStart[c], cellStart[c + 1], dz);
        }
      }
    }
  }
}

/// Where lists go.
struct ListWriter {
  int capacity;
  int room;
  int* entries;
  int* counts;
  float* crowding;
  Vec4f* places;  // null for `crowding`
  int* truncated;
  ListPacker packer;  // on CUDA

  WEIR_HD void finish(std::int64_t i, int found, int kept) const {
    if (found > kept) atomicAdd(truncated, 1);
    counts[i] = kept;
  }
  WEIR_HD void crowd(std::int64_t i, const Vec3f& p, float crowd) const {
    if (places != nullptr)
      storeWhole(places[i], Vec4f{p.x, p.y, p.z, crowd});
    else
      crowding[i] = crowd;
  }
};

/// The search of every back end, with which the others are compared. `Order` is InPlace or MergedOrder, in
/// which cells start at `cellStart`.
template <class Order>
struct FindNeighbors {
  Order order;
  ArrayView<const Vec3f> positions;
  ArrayView<const int> cellStart;
  CellGrid grid;
  float radiusSquared;
  ListWriter writer;
  Count count;    // of particles that get a list
  Count inOrder;  // of all, with the halo

  /// By way of scratch memory, from which neighbouring threads write whole lines.
  WEIR_HD void operator()(std::int64_t i, const Scratch& scratch) const {
    FoundNeighbors to{scratch};
    const int found = search(i, to);
    writer.finish(i, found, writer.packer.pack(i, to, GroupThreads(i, count.get())));
  }

  /// Returns how many there are.
  WEIR_HD int search(std::int64_t i, FoundNeighbors& to) const {
    const Scratch& list = to.index;
    float crowd = 0;
    const Vec3f p = positions[i];
    const int self = static_cast<int>(i);
    int found = 0;
    int own = 0, above = 0;
    forEachRangeNear(p, grid, cellStart, RowsWithinReach(p, grid), [&](int begin, int end, int layer) {
#ifdef __CUDA_ARCH__
#pragma unroll 2  // so that several positions are under way at once
#endif
      for (int place = begin; place < end; ++place) {
        const int j = order.particleAt(place);
        const Vec3f d = positions[j] - p;
        const float squared = dot(d, d);
        // Beyond the radius it adds 0, which costs less than to ask.
        crowd += crowdingAt(squared, grid);
        if (squared >= radiusSquared || j == self) continue;
        if (found < writer.capacity) list[found] = j;
        ++found;
      }
      if (layer < 0) own = found;
      if (layer <= 0) above = found;
    });
    writer.crowd(i, p, crowd);
    to.kept = found < writer.capacity ? found : writer.capacity;
    to.own = own < to.kept ? own : to.kept;
    to.above = above < to.kept ? above : to.kept;
    return found;
  }
};

#ifdef WEIR_HAS_EIGHT

/// Puts particles behind the ends of lists, up to that of the longest of eight, as sums over eight follow
/// them.
struct FillBehind {
  ListWriter writer;

  void operator()(std::int64_t begin, std::int64_t end) const {
    for (std::int64_t i = begin; i < end; i += kEight) {
      const std::int64_t size = std::min<std::int64_t>(end - i, kEight);
      const int longest = *std::max_element(writer.counts + i, writer.counts + i + size);
      for (std::int64_t lane = i; lane < i + size; ++lane)
        for (int k = writer.counts[lane]; k < longest; ++k)
          writer.entries[listPlace(lane, writer.room) + k * kInterleaved] = static_cast<int>(lane);
    }
  }
};

#endif

template <class Backend, class Order>
void searchPortably(Backend& device, std::string_view name, const FindNeighbors<Order>& find) {
#ifdef __CUDACC__
  parallelForWithScratch(device, name, find.count, find.writer.capacity, find);
#else
  // Straight into the list.
  parallelFor(device, name, find.count, [find](std::int64_t i) {
    FoundNeighbors to{Scratch{find.writer.entries + listPlace(i, find.writer.room), kInterleaved}};
    const int found = find.search(i, to);
    find.writer.finish(i, found, to.kept);
  });
#ifdef WEIR_HAS_EIGHT
  forEachRange(device, name, find.count, FillBehind{find.writer});
#endif
#endif
}

#if !defined(__CUDACC__) && defined(WEIR_HAS_LANES)

void fillPlaces(ThisBackend& device, const FindNeighbors<InPlace>& find, const detail::ShortPlaces& to) {
  parallelForEights(device, "columns", find.inOrder,
                    detail::FillShortPlaces{find.positions, find.grid.inverseCellSize, to});
}
void fillPlaces(ThisBackend& device, const FindNeighbors<MergedOrder>& find, const detail::ShortPlaces& to) {
  parallelForEights(device, "columns", find.inOrder,
                    detail::FillMergedPlaces{find.positions, find.grid.inverseCellSize, to, find.order});
}

template <class Order>
void searchByLanes(ThisBackend& device, std::string_view name, const FindNeighbors<Order>& find,
                   Array<float>& columns) {
  const ListWriter& to = find.writer;
  const detail::ShortPlaces places(columns, find.positions.size);
  fillPlaces(device, find, places);
  forEachRange(device, name, find.count,
               detail::LaneSearch<Order>{find.order,
                                         places,
                                         find.positions,
                                         find.cellStart,
                                         find.grid,
                                         find.radiusSquared,
                                         to.capacity,
                                         to.room,
                                         to.entries,
                                         to.counts,
                                         {to.crowding, find.positions.size},
                                         to.truncated});
}

#endif

// Sorting and listing borrow memory that nobody needs meanwhile.

/// What is asked until the lists are made.
struct Sorted {
  Lease<Vec4f> room;
  ArrayView<int> cellStart;  // where each cell starts
  FineCell* fine = nullptr;  // of the particles; null where nobody asks
};

Sorted sortedIn(ParticleSet& particles, std::int64_t cells, bool needsFine) {
  constexpr std::int64_t kInOne = sizeof(Vec4f) / sizeof(int);
  static_assert(sizeof(FineCell) == sizeof(int));
  const std::int64_t starts = cells + 1, fine = needsFine ? particles.capacity() + FineCell::kAhead : 0;
  Lease<Vec4f> room = particles.leaseUnordered((starts + fine + kInOne - 1) / kInOne);
  int* here = reinterpret_cast<int*>(room.data());
  return {std::move(room), {here, starts}, needsFine ? reinterpret_cast<FineCell*>(here + starts) : nullptr};
}

#ifdef __CUDACC__
/// What is forgotten when lists go into its place. Particles move to their spare memory meanwhile.
CellSortMemory sortMemory(std::int64_t count, ArrayView<int> start, Array<int>& entries) {
  WEIR_CHECK(entries.size() >= CellSort::kPerParticle * count);
  int* here = entries.data();
  return {start, {here, count}, {here + count, count}, {here + 2 * count, count}};
}
#else
/// The order is forgotten when lists go into its place.
CellSortMemory sortMemory(std::int64_t count, ArrayView<int> start, Array<int>& entries,
                          const Lease<Vec3f>& room) {
  int* words = reinterpret_cast<int*>(room.data());
  return {start, {words, count}, {words + count, count}, {entries.data(), count}};
}
#endif

/// The particles of each cell in the order of their ids, where they are not in it yet.
template <class Backend>
void putIntoOrderOfIds(Backend& device, const ArrayView<const int>& start, ArrayView<int> order,
                       const AttributeView<const std::int64_t>& ids, std::int64_t first) {
  parallelFor(device, "order by ids", start.size - 1,
              OrderCellByIds<IdsFrom>{start, order, {ids.view(), first}});
}

}  // namespace

template <class Backend>
void NeighborList::sortOn(Backend& device, ParticleSet& particles, const Aabb& domain,
                          ArrayView<const SinkPiece> sinks) {
  int* events = events_.data();
  Sorted sorted = sortedIn(particles, grid_.cellCount(), needsFineCells(particles.bound()));
  sortedRoom_ = std::move(sorted.room), cellStart_ = sorted.cellStart, fine_ = sorted.fine;
  fineRoom_ = particles.capacity();
  const ProfileScope scope(device.profiler(), "sort");
  const Count count = particles.count();
#ifdef __CUDACC__
  const CellSortMemory memory = sortMemory(count.bound, cellStart_, entries_);
  // A particle moves when its place is known, which takes a kernel less.
  detail::Permutation permutation(particles);
  const auto next = [&] {
    detail::Permute permute = permutation.next(memory.order);
    permute.fine = fine_;
    permute.inverseCellSize = grid_.inverseCellSize;
    return permute;
  };
#else
  Lease<Vec3f> room = particles.leaseVectors();
  const CellSortMemory memory = sortMemory(count.bound, cellStart_, entries_, room);
#endif
  const CellKey key{particles.pendingMotion(), grid_, domain, sinks, events + 1, events + 2, events + 3};
#ifdef __CUDACC__
  if (!ordersByIds_) {
    sortByCell(device, count, grid_.cellCount(), key, particles.counter(), memory, next());
    permutation.finish();
  } else {
    sortByCell(device, count, grid_.cellCount(), key, particles.counter(), memory);
    putIntoOrderOfIds(device, cellStart_, memory.order, std::as_const(particles).ids().read(), 0);
  }
  for (; permutation.isLeft(); permutation.finish())
    parallelFor(device, "permute", particles.count(), next());
#else
#ifdef WEIR_HAS_EIGHT
  // Where they are written once more.
  parallelForEights(device, "keys", count, WriteKeys{key, memory.cell});
  sortByCell(device, count, grid_.cellCount(), WrittenKey{memory.cell}, particles.counter(), memory);
#else
  sortByCell(device, count, grid_.cellCount(), key, particles.counter(), memory);
#endif
  if (ordersByIds_)
    putIntoOrderOfIds(device, cellStart_, memory.order, std::as_const(particles).ids().read(), 0);
  room = {};
  particles.permute(memory.order);
#endif
}

template <class Backend>
void NeighborList::mergeHaloOn(Backend& device, const ParticleSet& particles) {
  const ProfileScope scope(device.profiler(), "halo");
  const std::int64_t owned = particles.bound(), halo = particles.haloCount();
  const AttributeView<const std::int64_t> ids = particles.ids().read();
  haloListed_.resizeDiscarding(1);
  haloCells_.sort(device, halo, grid_.cellCount(), HaloKey{particles.positions().read(), grid_, owned},
                  haloListed_.data());
  putIntoOrderOfIds(device, haloCells_.start(), haloCells_.orderToChange(), ids, owned);
  mergedStart_.resizeDiscarding(cellStart_.size);
  merged_.resizeDiscarding(owned + halo + MergedOrder::kBehind);
  merged_.fillZero();  // what is in no cell is at no place
  mergedPlaces_.resizeDiscarding(owned);
  parallelFor(device, "merge", cellStart_.size,
              MergeCell{cellStart_, haloCells_.start(), haloCells_.order().data, static_cast<int>(owned),
                        ids.view(), mergedStart_.view(), merged_.data(), mergedPlaces_.data()});
}

template <class Backend>
void NeighborList::listOn(Backend& device, const ParticleSet& particles, float* crowding, Vec4f* places) {
  const Count owned = particles.count(), all = particles.countWithHalo();
  constexpr std::string_view kName = "find neighbours";
  const ListWriter writer{
      capacity_,       room_,
      entries_.data(), counts_.data(),
      crowding,        places,
      events_.data(),  {packed(), events_.data() + 3, events_.data() + 4, all.bound <= kAllInWindows}};
  const auto finding = [&]<class Order>(const Order& order, ArrayView<const int> cellStart) {
    return FindNeighbors<Order>{
        order, particles.positions().read(), cellStart, grid_, radius_ * radius_, writer, owned, all};
  };
  const auto find = finding(InPlace{}, cellStart_);
  if (mergesHalo(particles)) {
    const auto both = finding(MergedOrder{merged_.data(), mergedPlaces_.data()}, mergedStart_.view());
#if defined(__CUDACC__)
    if (!usesPortableSearch_ && fine_ != nullptr)
      return searchBesideHalo(device, kName, owned, capacity_, find, both, fine_, haloCells_.start().data);
#elif defined(WEIR_HAS_LANES)
    if (!usesPortableSearch_) return searchByLanes(device, kName, both, columns_);
#endif
    return searchPortably(device, kName, both);
  }
  if (usesPortableSearch_) return searchPortably(device, kName, find);
#if defined(__CUDACC__)
  static_assert(kFewForTeams <= kAllInWindows);
  // Teams list in an order of their own. The halo may have come to more than there was room for.
  if (ordersByIds_ && (fine_ == nullptr || all.bound > fineRoom_)) return searchPortably(device, kName, find);
  if (particles.haloCount() > 0)
    parallelFor(device, "fine cells", particles.haloCount(),
                FillFine{find.positions, grid_.inverseCellSize, particles.bound(), fine_});
  searchOnGpu<kFewForTeams>(device, kName, owned, capacity_, find, fine_);
#elif defined(WEIR_HAS_LANES)
  searchByLanes(device, kName, find, columns_);
#else
  searchPortably(device, kName, find);
#endif
}

template void NeighborList::sortOn(ThisBackend&, ParticleSet&, const Aabb&, ArrayView<const SinkPiece>);
template void NeighborList::mergeHaloOn(ThisBackend&, const ParticleSet&);
template void NeighborList::listOn(ThisBackend&, const ParticleSet&, float*, Vec4f*);

}  // namespace weir
