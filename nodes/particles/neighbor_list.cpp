#include "nodes/particles/neighbor_list.h"

#include <algorithm>
#include <cmath>

#include "framework/graph/memory_estimate.h"
#include "nodes/particles/neighbor_sum.h"

namespace weir {

static_assert(sizeof(NeighborEvents) == 3 * sizeof(int));

namespace {

// About one particle a cell fills a dense block at a support of 1.2 spacings; splashes may use more cells.
constexpr std::int64_t kCellsPerParticle = 4;
constexpr std::int64_t kFewestCells = 1 << 12;
constexpr std::int64_t kMostCells = std::int64_t{1} << 30;

}  // namespace

NeighborList::NeighborList(Device& device)
    : shift_(device.kind() == DeviceKind::kCuda ? 5 : 0),
      entries_(device),
      counts_(device),
      columns_(device),
      events_(device) {
  events_.resize(3);
  events_.fillZero();
}

void NeighborList::configure(float radius, int capacity) {
  WEIR_CHECK(radius > 0);
  WEIR_CHECK(capacity > 0);
  radius_ = radius;
  capacity_ = capacity;
  room_ = shift_ == 0 ? (capacity + kListPiece - 1) / kListPiece * kListPiece : capacity;
  grid_ = chooseCellGrid({}, radius, 0);
}

void NeighborList::fitGrid(const Aabb& box, std::int64_t particles) {
  box_ = box;
  // A fluid that grows between two frames leaves the box that it had; with this many cells, those of
  // different places that share storage do not hold many particles.
  constexpr std::int64_t kParticlesPerCell = 4;
  grid_ = chooseCellGrid(box, radius_, std::clamp(kCellsPerParticle * particles, kFewestCells, kMostCells),
                         particles / kParticlesPerCell);
  fittedFor_ = particles;
}

void NeighborList::build(ParticleSet& particles, const Aabb& domain, ArrayView<const SinkPiece> sinks) {
  if (particles.bound() > 2 * fittedFor_) fitGrid(box_, particles.bound());
  makeRoom(particles.capacity());
  dispatch(particles.device(), [&](auto& device) { buildOn(device, particles, domain, sinks); });
}

void NeighborList::makeRoom(std::int64_t particles) {
  const std::int64_t lists = paddedLists(particles);
  counts_.resizeDiscarding(lists);
  entries_.resizeDiscarding(lists * room_);
}

double NeighborList::memoryFor(double particles) const {
  const double lanes = std::int64_t{1} << shift_, lists = std::ceil(particles / lanes) * lanes;
  const double cells = std::clamp(kCellsPerParticle * particles, double(kFewestCells), double(kMostCells));
  constexpr double kStartsInOne = sizeof(Vec4f) / sizeof(int);  // of wideScratch()
  double bytes = bytesOfArrays(lists, counts_) + bytesOfArrays(lists * room_, entries_) +
                 bytesOfArray(std::max(particles, cells / kStartsInOne + 1), sizeof(Vec4f));
  // The columns of coordinates that the CPU reads, with what is behind their ends.
  if (shift_ == 0) bytes += bytesOfArrays(3 * (particles + 2 * kListPiece), columns_);
  return bytes;
}

void NeighborList::save(const StateWriter& to) const {
  to.put("grid", grid_);
  to.put("box", box_);
  to.put("fitted_for", fittedFor_);
  to.put("events", events_, events_.size());
}

void NeighborList::restore(const StateReader& from) {
  from.get("grid", grid_);
  from.get("box", box_);
  from.get("fitted_for", fittedFor_);
  from.get("events", events_);
}

NeighborView NeighborList::view() const {
  return {entries_.data(), counts_.data(), room_, shift_};
}

NeighborEditor NeighborList::editor() {
  return {entries_.data(), counts_.data(), view()};
}

NeighborEvents NeighborList::eventsOnHost() const {
  const std::vector<int> values = events_.toHost();
  return {values[0], values[1], values[2]};
}

}  // namespace weir
