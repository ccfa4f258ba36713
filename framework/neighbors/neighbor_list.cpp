#include "framework/neighbors/neighbor_list.h"

#include <algorithm>
#include <cmath>

#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"

namespace weir {

constexpr std::int64_t kEvents = 5;
static_assert(sizeof(NeighborEvents) == kEvents * sizeof(int));

namespace {

// About one particle a cell fills a dense block at a support of 1.2 spacings; splashes may use more cells.
constexpr std::int64_t kCellsPerParticle = 4;
constexpr std::int64_t kMinCells = 1 << 12;
constexpr std::int64_t kMaxCells = std::int64_t{1} << 30;
// A fluid that grows between two frames leaves the box that it had; with this many cells, those of different
// places that share storage do not hold many particles.
constexpr std::int64_t kParticlesPerCell = 4;
// A block for every kGroupsPerBlock groups of lists, and a few. At rows of cells that the grid wraps around,
// and where few particles lie above many, groups are wide; blocks are for those with long lists among them.
constexpr std::int64_t kGroupsPerBlock = 64;
constexpr std::int64_t kMinBlocks = 16;

std::int64_t maxCellsFor(std::int64_t particles) {
  return std::clamp(kCellsPerParticle * particles, kMinCells, kMaxCells);
}

/// A box without its height along z.
Aabb flat(const Vec3f& low, const Vec3f& high) {
  return low.x <= high.x ? Aabb{{low.x, low.y, 0}, {high.x, high.y, 0}} : Aabb{};
}

/// As checkpoints have a grid.
struct SavedGrid {
  float inverseCellSize = 1;
  Vec3i cells;
};

}  // namespace

NeighborList::NeighborList(Device& device)
    : packs_(device.kind() == DeviceKind::kCuda),
      entries_(device),
      counts_(device),
      groups_(device),
      blocks_(device),
      columns_(device),
      events_(device),
      haloCells_(device),
      haloListed_(device),
      mergedStart_(device),
      merged_(device),
      mergedPlaces_(device) {
  events_.resize(kEvents);
  events_.fillZero();
}

void NeighborList::configure(float radius, int capacity) {
  WEIR_CHECK(radius > 0);
  WEIR_CHECK(capacity > 0);
  WEIR_CHECK(capacity <= kMaxScratch);
  radius_ = radius;
  capacity_ = capacity;
  const int piece = packs_ ? kCodesTogether : kInterleaved;
  room_ = (capacity + piece - 1) / piece * piece;
  grid_ = chooseCellGrid({}, radius, 0);
}

void NeighborList::fitGrid(const Aabb& box, std::int64_t particles, const std::optional<Vec3f>& mean) {
  slab_.reset();
  box_ = box;
  grid_ = chooseCellGrid(box, radius_, maxCellsFor(particles), particles / kParticlesPerCell, mean);
  fittedFor_ = particles;
}

void NeighborList::fitSlab(const Slab& slab, const Aabb& box, std::int64_t particles) {
  slab_ = slab;
  box_ = box;
  grid_ = {.slowestAxis = slab.own.axis};
  const Aabb inLayer = flat(grid_.along(box.lo), grid_.along(box.hi));
  const std::int64_t maxInLayer = maxCellsFor(particles) / slab.all.count;
  const Vec3i cells = chooseCellGrid(inLayer, radius_, CellGrid::kMinCells * maxInLayer).cells;
  constexpr int kLayersOfHalo = 2;
  grid_.inverseCellSize = 1.0f / radius_;
  grid_.firstLayer = slab.own.first;
  grid_.slabLayers = std::max(slab.own.count, 1);
  grid_.cells = {cells.x, cells.y, grid_.slabLayers + kLayersOfHalo};
  fittedFor_ = particles;
}

void NeighborList::fitMore(std::int64_t particles) {
  if (particles <= 2 * fittedFor_) return;
  if (slab_)
    fitSlab(*slab_, box_, particles);
  else
    fitGrid(box_, particles);
}

void NeighborList::build(ParticleSet& particles, const Aabb& domain, ArrayView<const SinkPiece> sinks,
                         PeriodicImages* images) {
  if (images != nullptr) images->wrap();
  sort(particles, domain, sinks);
  if (images != nullptr) images->show();
  list(particles);
}

void NeighborList::sort(ParticleSet& particles, const Aabb& domain, ArrayView<const SinkPiece> sinks) {
  sortedRoom_ = {};
  fitMore(particles.bound());
  makeRoom(particles.capacity());
  dispatch(particles.device(), [&](auto& device) { sortOn(device, particles, domain, sinks); });
}

void NeighborList::list(ParticleSet& particles) {
  const bool isSorted = sortedRoom_.isLent();
  WEIR_CHECK(isSorted);
  const std::int64_t halo = particles.haloCount();
  makeRoom(particles.capacity(), mergesHalo(particles) ? halo : 0);
  if (mergesHalo(particles))
    dispatch(particles.device(), [&](auto& device) { mergeHaloOn(device, particles); });
  const Version positions = particles.positions().version();
  const Lease<Vec3f> room = particles.leaseVectors();
  const ArrayView<float> crowding{reinterpret_cast<float*>(room.data()), room.size()};
  ByProducts& byProducts = particles.byProducts();
  byProducts.forget(kCrowding);
  byProducts.forget(kPlaces);
  Lease<Vec4f> places;
  // Those of the halo are not found here; where sets share particles, all of them do as those with a halo.
  const bool leavesPlaces = packs_ && particles.hasPlaces() && halo == 0 && !ordersByIds_;
  if (leavesPlaces) {
    places = particles.leasePlaces();
    byProducts.keep<Vec4f>(kPlaces, places.view(), {positions, places.version()});
  } else {
    byProducts.keep<float>(kCrowding, crowding, {positions, room.version()});
  }
  dispatch(particles.device(), [&](auto& device) {
    const ProfileScope scope(device.profiler(), "list");
    listOn(device, particles, crowding.data, leavesPlaces ? places.data() : nullptr);
  });
  sortedRoom_ = {};
}

void NeighborList::makeRoom(std::int64_t particles, std::int64_t halo) {
  counts_.resizeDiscarding(particles);
  if (!packs_) {
    entries_.resizeDiscarding((particles + kInterleaved - 1) / kInterleaved * kInterleaved * room_);
    return;
  }
  const std::int64_t groups = groupsOf(particles);
  const std::int64_t entries =
      std::max(groups * kListGroup * room_ / kCodesInInt, CellSort::kPerParticle * particles);
  const bool fresh = entries_.capacity() < entries;
  entries_.resizeDiscarding(entries);
  // Codes are read four at a time, those behind a list's end with them.
  if (fresh) entries_.fillZero();
  groups_.resizeDiscarding(groups);
  const std::int64_t indices = blocksFor(particles, halo) * room_ * kListGroup;
  const bool freshBlocks = blocks_.capacity() < indices;
  blocks_.resizeDiscarding(indices);
  if (freshBlocks) blocks_.fillZero();
}

std::int64_t NeighborList::blocksFor(std::int64_t particles, std::int64_t halo) const {
  if (particles + halo <= kAllInWindows) return 0;
  const std::int64_t groups = groupsOf(particles);
  // A window holds two rows of cells and what is between them.
  constexpr int kRows = 4;
  if (std::int64_t{kRows} * grid_.cells.x > kWindow) return groups;
  // The halo stands far from its neighbours in memory, so their groups are wide.
  return std::min(groups,
                  std::max(groups / kGroupsPerBlock + kMinBlocks, grownSize(blocksWanted_, 0)) + halo);
}

double NeighborList::memoryFor(double particles) const {
  const double cells = std::clamp(kCellsPerParticle * particles, double(kMinCells), double(kMaxCells));
  constexpr double kStartsInOne = sizeof(Vec4f) / sizeof(int);  // of ParticleSet::leaseUnordered()
  const double fine = needsFineCells(static_cast<std::int64_t>(particles)) ? particles + FineCell::kAhead : 0;
  const double bytes = bytesOfArrays(particles, counts_) +
                       bytesOfArray(std::max(particles, (cells + fine) / kStartsInOne + 2), sizeof(Vec4f));
  // The columns of coordinates that the CPU reads, two in a float, with what is behind their ends.
  constexpr double kFloats = 1.5, kBehind = 64;
  if (!packs_)
    return bytes + bytesOfArrays((particles + kInterleaved) * room_, entries_) +
           bytesOfArrays(kFloats * (particles + kBehind), columns_);
  const double groups = std::ceil(particles / kListGroup);
  const double blocks = particles <= kAllInWindows ? 0 : groups / kGroupsPerBlock + kMinBlocks;
  const double entries =
      std::max(groups * kListGroup * room_ / kCodesInInt, CellSort::kPerParticle * particles);
  return bytes + bytesOfArrays(entries, entries_) + bytesOfArrays(groups, groups_) +
         bytesOfArrays(blocks * room_ * kListGroup, blocks_);
}

void NeighborList::save(const StateWriter& to) const {
  to.put("grid", SavedGrid{grid_.inverseCellSize, grid_.cells});
  to.put("box", box_);
  to.put("fitted_for", fittedFor_);
  to.put("events", events_, events_.size());
}

void NeighborList::restore(const StateReader& from) {
  SavedGrid saved;
  from.get("grid", saved);
  slab_.reset();
  grid_ = {.inverseCellSize = saved.inverseCellSize, .cells = saved.cells};
  from.get("box", box_);
  from.get("fitted_for", fittedFor_);
  from.get("events", events_);
}

PackedLists NeighborList::packed() {
  if (!packs_) return {};
  return {reinterpret_cast<FourCodes*>(entries_.data()), groups_.data(), blocks_.data(),
          static_cast<int>(blocks_.size() / (std::int64_t{room_} * kListGroup)), room_};
}

NeighborView NeighborList::view() const {
  // Of a view, nobody writes to the lists.
  return {entries_.data(), counts_.data(), room_, const_cast<NeighborList*>(this)->packed()};
}

NeighborEditor NeighborList::editor() {
  return {entries_.data(), counts_.data(), room_, packed()};
}

NeighborEvents NeighborList::eventsOnHost() {
  const std::vector<int> values = events_.toHost();
  blocksWanted_ = values[3];
  return {values[0], values[1], values[2], values[3], values[4]};
}

std::vector<std::vector<int>> NeighborList::listsOnHost(std::int64_t particles) const {
  const std::vector<int> counts = countsOnHost(particles);
  std::vector<int> entries = entries_.toHost(), blocks = blocks_.toHost();
  std::vector<ListGroup> groups = groups_.toHost(packs_ ? groupsOf(particles) : 0);
  NeighborView lists = view();
  lists.entries = entries.data();
  lists.counts = counts.data();
  if (packs_) {
    lists.packed.codes = reinterpret_cast<FourCodes*>(entries.data());
    lists.packed.groups = groups.data();
    lists.packed.blocks = blocks.data();
  }
  std::vector<std::vector<int>> all(static_cast<std::size_t>(particles));
  for (std::int64_t i = 0; i < particles; ++i)
    forEachNeighbor(i, lists, [&](int j) { all[static_cast<std::size_t>(i)].push_back(j); });
  return all;
}

}  // namespace weir
