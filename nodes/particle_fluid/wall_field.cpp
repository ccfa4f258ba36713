#include "nodes/particle_fluid/wall_field.h"

#include <algorithm>
#include <cstring>

#include "framework/graph/memory_estimate.h"
#include "nodes/particle_fluid/body_coupling.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

bool WallField::hasBodies() const {
  return std::any_of(solids.begin(), solids.end(),
                     [](const Solid* solid) { return solid->isMovedByForces(); });
}

namespace {

bool haveSameBytes(const std::vector<SolidView>& a, const std::vector<SolidView>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(SolidView)) == 0);
}

}  // namespace

void WallField::place(double time, double dt, const Vec3f& gravity) {
  const double length = still ? 0 : dt;
  std::vector<SolidView> placed;
  for (Solid* solid : solids) placed.push_back(solid->view(time, length));
  // What has changed in `views` since is made anew below. Bodies look the same in every step.
  if (!haveSameBytes(placed, placed_)) views.assign(placed);
  placed_.swap(placed);
  // Without meet() nobody knows how near things come.
  if (placed_.size() != sortedSolids_ && reach_ > 0) {
    grid.fit(placed_, reach_, reach_, gap_);
    sortedSolids_ = placed_.size();
  }
  moves = hasBodies() && length > 0;
  moved = false;
  placeBodies(*this, gravity, length);
}

void WallField::fit(ParticleSet& particles) {
  stride = particles.capacity();
  total.resizeDiscarding(stride);
  foundAt.resizeDiscarding(stride);
  d.resizeDiscarding(stride);
  if (curves) curvature.resizeDiscarding(stride), curvatureOff.resizeDiscarding(stride);
  legal.resizeDiscarding(stride);
  marks.resizeDiscarding(stride);
  met.resizeDiscarding(stride);
  kick.resizeDiscarding(stride);
  impulses.resizeDiscarding(2 * views.size());
  if (moves) {
    lift.resizeDiscarding(stride);
    grip.resizeDiscarding(stride);
    bodySums.resizeDiscarding(views.size());
  }
  addShare(particles);
}

void WallField::addShare(ParticleSet& particles) {
  share = particles.add<float>({"wall_share", AttributeType::kFloat, "m^2",
                                "Displacement by walls in the last step, over the gradient of Φ."});
}

void WallField::meet(const std::vector<const Boundary*>& boundaries, const FluidConstants& constants,
                     ParticleSet& particles) {
  std::vector<BoundaryPiece> all;
  std::vector<Measured> reporting;
  reporting_.clear();
  for (const Boundary* of : boundaries) {
    const std::ptrdiff_t first = std::ssize(all);
    all.insert(all.end(), of->pieces.begin(), of->pieces.end());
    if (of->impulses == nullptr) continue;
    reporting_.push_back(of->impulses);
    for (auto piece = all.begin() + first; piece != all.end(); ++piece)
      piece->measured = static_cast<int>(reporting.size());
    SolidImpulse* sum = of->impulses->data();
    reporting.push_back({sum, of->pivot, static_cast<int>(of->parts.size()), {}});
    for (const Aabb& box : of->parts) reporting.push_back({++sum, of->pivot, 0, box});
  }
  measured.assign(reporting);
  boundaryImpulses.resizeDiscarding(measured.size());
  rubs = std::any_of(all.begin(), all.end(), [](const BoundaryPiece& of) { return of.friction > 0; });
  bounces = std::any_of(all.begin(), all.end(), [](const BoundaryPiece& of) { return of.restitution > 0; });
  if (rubs || !reporting.empty()) addShare(particles);
  pieces_.assign(all);
  reach_ = constants.supportRadius;
  gap_ = kSolidGap * constants.spacing;
  sortedSolids_ = 0;
  boundary = {.boundary = {.pieces = pieces_.data(),
                           .count = static_cast<int>(all.size()),
                           .first = all.empty() ? BoundaryPiece{} : all.front()},
              .radius = constants.wallRadius,
              .factor = constants.wallFactor};
}

void WallField::forgetImpulses() {
  for (Solid* solid : solids) solid->impulse().fillZero();
  for (Array<SolidImpulse>* sums : reporting_) sums->fillZero();
}

void FluidStep::findWalls() {
  if (walls.empty()) return;
  WEIR_CHECK(wallFinder != nullptr);
  wallFinder->findWalls(*this);
}

double WallField::memoryFor(const FluidRoom& room) const {
  const double n = room.particles;
  double bytes = room.wallShares ? ParticleSet::memoryOfAttribute(n, AttributeType::kFloat) : 0;
  if (room.boundaryForces) bytes += bytesOfArrays(n, velocitiesBefore);
  if (room.solids == 0) return bytes;
  return bytes + SolidGrid::memoryFor(room.solids) + KeyLists::memoryFor(n, room.solids) +
         pairs.memoryFor(n, room.solids, sizeof(Vec4f) + sizeof(int)) +
         bytesOfArrays(n, total, foundAt, curvature, curvatureOff, d, legal, marks, met, kick);
}

}  // namespace weir
