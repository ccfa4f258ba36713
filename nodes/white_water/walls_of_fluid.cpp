#include "nodes/white_water/walls_of_fluid.h"

#include <algorithm>
#include <limits>

#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/white_water/fluid_walls.h"

namespace weir {

WallsOfFluid::WallsOfFluid(Device& device, const ParticleFluid* fluid, int* removed)
    : fluid_(fluid), pieces_(device), sinks_(device), solids_(device) {
  if (fluid != nullptr) findBoundaries(removed);
}

void WallsOfFluid::findBoundaries(int* removed) {
  std::vector<BoundaryPiece> pieces;
  for (std::size_t i = 0; i < fluid_->boundaries.size(); ++i)
    for (const BoundaryPiece& piece : fluid_->boundaries[i].pieces) pieces.push_back(piece);
  pieces_.assign(pieces);
  boundary_ = {.pieces = pieces_.data(),
               .count = static_cast<int>(pieces.size()),
               .first = pieces.empty() ? BoundaryPiece{} : pieces.front()};
  std::vector<SinkPiece> sinks;
  for (std::size_t i = 0; i < fluid_->sinks.size(); ++i)
    for (SinkPiece piece : fluid_->sinks[i].pieces) {
      piece.removed = removed;
      sinks.push_back(piece);
    }
  sinks_.assign(sinks);
}

void WallsOfFluid::place(double time, double dt, Array<Pose>& poses) {
  if (fluid_ == nullptr || fluid_->solids().empty()) return;
  std::vector<SolidView> views;
  for (Solid* solid : fluid_->solids()) views.push_back(solid->view(time, dt));
  solids_.assign(views);
  const auto& solids = fluid_->solids();
  if (std::none_of(solids.begin(), solids.end(), [](const Solid* of) { return of->isMovedByForces(); }))
    return;
  const bool known = poses.size() == solids_.size();
  if (!known) poses.resizeDiscarding(solids_.size());
  dispatch(solids_.device(), [&](auto& device) { placeBodiesOn(device, poses, known); });
}

FluidWalls WallsOfFluid::view() const {
  constexpr float kFar = std::numeric_limits<float>::max();
  if (fluid_ == nullptr) return {.domain = {{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}}};
  const FluidConstants& constants = fluid_->constants();
  return {.boundary = boundary_,
          .contact = constants.contact,
          .exact = constants.wallRadius,
          .solids = solids_.view(),
          .gap = kSolidGap * constants.spacing,
          .sinks = sinks_.view(),
          .domain = {fluid_->domainMin.get().value_or(Vec3f{-kFar, -kFar, -kFar}),
                     fluid_->domainMax.get().value_or(Vec3f{kFar, kFar, kFar})}};
}

}  // namespace weir
