#include "nodes/particles/neighbor_list.h"

#include <algorithm>

#include "nodes/particles/neighbor_sum.h"

namespace weir {

static_assert(sizeof(NeighborEvents) == 3 * sizeof(int));

NeighborList::NeighborList(Device& device)
    : shift_(device.kind() == DeviceKind::kCuda ? 5 : 0),
      sort_(device),
      entries_(device),
      counts_(device),
      crowding_(device),
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
  // About one particle a cell fills a dense block at a support of 1.2 spacings; splashes may use more cells.
  constexpr std::int64_t kCellsPerParticle = 4;
  constexpr std::int64_t kFewestCells = 1 << 12;
  constexpr std::int64_t kMostCells = std::int64_t{1} << 30;
  // A fluid that grows between two frames leaves the box that it had; with this many cells, those of
  // different places that share storage do not hold many particles.
  constexpr std::int64_t kParticlesPerCell = 4;
  grid_ = chooseCellGrid(box, radius_, std::clamp(kCellsPerParticle * particles, kFewestCells, kMostCells),
                         particles / kParticlesPerCell);
  fittedFor_ = particles;
}

void NeighborList::build(ParticleSet& particles, const Aabb& domain, ArrayView<const SinkPiece> sinks) {
  if (particles.bound() > 2 * fittedFor_) fitGrid(box_, particles.bound());
  dispatch(particles.device(), [&](auto& device) { buildOn(device, particles, domain, sinks); });
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
