#include "nodes/particle_fluid/modules/two_projections.h"

#include <fmt/format.h>

#include <algorithm>

#include "framework/graph/setting_warning.h"
#include "nodes/particle_fluid/modules/projection_bodies.h"
#include "nodes/particle_fluid/modules/projection_packing.h"
#include "nodes/particle_fluid/scratch.h"

namespace weir {

void TwoProjections::reset(FluidStep& fluid) {
  record_ = {};
  pressure_ = fluid.particles.add<float>({"projection_pressure", AttributeType::kFloat, "Pa",
                                          "Pressure that has kept velocities free of divergence."});
}

void TwoProjections::warn(const FluidOutlook& outlook) const {
  constexpr double kLeastRatio = 1.8;
  const double ratio = outlook.constants.supportRadius / outlook.constants.spacing;
  if (ratio >= kLeastRatio * (1 - kSettingRounding)) return;
  outlook.warn(
      *this,
      fmt::format("with a support_ratio of {:.3g} water boils at the edges of tanks: there are too few "
                  "neighbours for its operator",
                  ratio),
      "a support_ratio of 2, or another solver");
}

void TwoProjections::fit(FluidStep& fluid) {
  fitScratch(fluid, state_, weighted_, wallDistances_, wallKeys_, diagonal_, off_, wall_, u_, push_,
             displacement_, rowX_, rowY_, rowZ_, q_, room_, source_, residual_, direction_, product_,
             preconditioner_);
  if (wrenches_.data() == nullptr)
    wrenches_ = Array<Twist>(fluid.device), wallOfPair_ = Array<Vec4f>(fluid.device);
  wrenches_.resizeDiscarding(fluid.walls.views.size());
  wallOfPair_.resizeDiscarding(fluid.walls.moves ? fluid.walls.pairs.room() : 0);
  if (sums_.data() != nullptr) return;
  sums_ = Array<projection::ProjectionSums>(fluid.device, 2 * kTogether);
  active_ = Array<int>(fluid.device, 1);
}

ProjectionPacking TwoProjections::packingOf(FluidStep& fluid) {
  return {fluid.neighbors.view(),
          pairGradientOf(fluid.constants),
          state_.view(),
          wallDistances_.view(),
          wallKeys_.view(),
          diagonal_.view(),
          off_.view(),
          wall_.view()};
}

projection::BodiesAtParticles TwoProjections::bodiesOf(FluidStep& fluid) {
  const WallField& walls = fluid.walls;
  return {.solids = walls.views.view(),
          .pairs = walls.pairs.view(),
          .near = walls.pairs.near(),
          .predicted = fluid.particles.positions().read(),
          .wallOfPair = std::as_const(wallOfPair_).view(),
          .particleMass = double(fluid.constants.particleMass)};
}

double TwoProjections::memory(const FluidRoom& room) const {
  constexpr double kUsualPairs = 2;  // of a particle, as SolidPairs has room for
  return bytesOfArrays(room.particles, state_, weighted_, wallDistances_, wallKeys_, diagonal_, off_, wall_,
                       u_, push_, displacement_, rowX_, rowY_, rowZ_, q_, room_, source_, residual_,
                       direction_, product_, preconditioner_) +
         room.particles * sizeof(float) +
         (room.solids > 0 ? kUsualPairs * bytesOfArrays(room.particles, wallOfPair_) : 0);
}

void TwoProjections::report(NodeReport& report) {
  const Record& done = record_;
  report.statistics["projection_iterations"] =
      double(done.iterations) / double(std::max<std::int64_t>(done.steps, 1));
  report.events.push_back({"steps in which the projection did not come to its tolerance", done.unfinished});
}

}  // namespace weir
