#include "nodes/particle_fluid/modules/accelerated_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/graph/setting_warning.h"
#include "nodes/particle_fluid/modules/accelerated_judge.h"
#include "nodes/particle_fluid/modules/conjugate_passes.h"
#include "nodes/particle_fluid/pressure_problem.h"
#include "nodes/particle_fluid/scratch.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

/// γ of a settled fluid of these constants (fluid_constants.h). What is calibrated by a lattice settles more
/// densely, at a response that was not measured: 1, the most that there can be.
double responseOf(const FluidConstants& c) {
  constexpr double kRounding = 1e-5;
  const double ratio = double(c.supportRadius) / double(c.spacing), packing = packingCalibration(ratio);
  return std::abs(double(c.calibration) - packing) < kRounding * packing ? settledResponse(ratio) : 1.0;
}

class Moved final : public MovedParameters {
 public:
  std::string_view from() const override { return "SemiImplicitSolver"; }
  std::string_view to() const override { return AcceleratedSolver::kInfo.type; }
  std::vector<Parameter> parameters() const override {
    return {{"tolerance", "tolerance", Value()},
            {"acceleration", "acceleration", "none"},
            {"neighbor_searches", "neighbor_searches", Value()},
            {"path_stages", "path_stages", 16}};
  }
  std::vector<Parameter> renamed() const override { return {{"iterations", "max_iterations", 3}}; }
  bool matter(const Value& params) const override {
    const auto differs = [&](std::string_view name, const Value& neutral) {
      const Value* value = params.find(name);
      return value != nullptr && !value->isNull() && !(*value == neutral);
    };
    // Stages of the path there are with a tolerance only.
    return differs("tolerance", {}) || differs("acceleration", "none") || differs("neighbor_searches", 1);
  }
};

}  // namespace

std::unique_ptr<MovedParameters> movedFromSemiImplicitSolver() {
  return std::make_unique<Moved>();
}

void AcceleratedSolver::validate() const {
  PressureSolver::validate();
  if (!conjugates()) return;
  if (!conservative)
    throw sceneError(
        "conjugate gradients are of an objective, which forces that are not conservative have not",
        "\"conservative\": true, or another acceleration")
        .inParameter(conservative.name());
  if (searches())
    throw sceneError("conjugate gradients search the length of a step themselves",
                     "\"step_length\": \"full\", or another acceleration")
        .inParameter(stepLength.name());
}

void AcceleratedSolver::reset(FluidStep& fluid) {
  PressureSolver::reset(fluid);
  control_ = Array<Control>(fluid.device);
  control_->assign(std::vector<Control>{Control{}});
  farthest_ = Array<float>(fluid.device);
  farthest_.resize(1);
  controlSeen_.emplace(fluid.device);
  passes_ = 0;
  directions_.release();
  held_ = {};
  carried_ = carries()
                 ? fluid.particles.add<Vec3f>({.name = "displacement",
                                               .unit = "m",
                                               .doc = "By pressure and walls, at the last search in a step.",
                                               .internal = true})
                 : Attribute<Vec3f>();
}

ConjugateView AcceleratedSolver::conjugateView() {
  ConjugateView view = directions_.view();
  if (followsHeld()) view.held = held_.write();
  return view;
}

void AcceleratedSolver::warn(const FluidOutlook& outlook) const {
  if (tolerance.get()) {
    const FluidConstants& c = outlook.constants;
    // The mean over a column of depth h, at rest: ρ0·g·h/(2·γ·K').
    const double bearing = 0.5 * outlook.pressure / responseOf(c), atRest = bearing / c.bulkModulus;
    if (atRest > *tolerance.get() * (1 + kSettingRounding))
      outlook.warn(*this,
                   fmt::format("a tolerance of {:.3g} cannot be met: at rest the fluid's mean compression is "
                               "{:.3g}, from its weight and bulk_modulus",
                               *tolerance.get(), atRest),
                   fmt::format("a tolerance of at least {:.2g}, or a bulk_modulus of at least {:.2g} Pa",
                               atRest, bearing / (*tolerance.get() * c.stiffened)));
    return;
  }
  warnOfFew(outlook, maxIterations, "a tolerance");
}

Acceleration AcceleratedSolver::chosen() const {
  if (acceleration != Acceleration::kAuto) return acceleration;
  return conservative && !searches() && !besideBodies_ ? Acceleration::kConjugate : Acceleration::kNesterov;
}

void AcceleratedSolver::refuseBodies(const FluidStep& fluid) const {
  if (!fluid.walls.moves || !conjugates()) return;
  throw sceneError("conjugate gradients do not move bodies", "another acceleration beside a RigidBody")
      .inParameter(acceleration.name());
}

void AcceleratedSolver::askForCurvature(FluidStep& fluid) {
  const bool curves = conjugates() && !fluid.walls.empty();
  if (curves == fluid.walls.curves) return;
  fluid.walls.curves = curves;
  fluid.findWalls();  // this step's were found before
}

bool AcceleratedSolver::isDone() {
  if (!tolerance.get()) return false;
  if (!controlSeen_->pending()) return false;
  // The device decides in the middle of an iteration, and is busy with the rest of it while the host hears of
  // that. Iterations that it is given beyond the end change nothing, but take time.
  const Control seen = controlSeen_->wait();
  if (seen.passes != passes_) return false;
  over_ = seen.over != 0;
  return seen.done != 0;
}

void AcceleratedSolver::endPass(int pass) {
  if (!tolerance.get() || (neighborSearches.get() && pass + 1 < passes())) return;
  if (controlSeen_->pending()) controlSeen_->wait();
  controlSeen_->request(control_->data());
  over_ = controlSeen_->wait().over != 0;
}

bool AcceleratedSolver::staged(const FluidStep& fluid) const {
  return tolerance.get() && pathStages > 1 && fluid.walls.empty();
}

int AcceleratedSolver::maxRepeats() const {
  constexpr int kMax = 10;
  return tolerance.get() && !neighborSearches.get() ? kMax : 0;
}

int AcceleratedSolver::maxPasses() const {
  // One may be idle, see BeginPass.
  return tolerance.get() ? 1 + pathStages * (1 + maxRepeats()) + passes() : passes();
}

void AcceleratedSolver::reserve(FluidStep& fluid) {
  const bool walls = fluid.walls.keepsShares();
  if (conjugates()) directions_.reserve(fluid);
  if (fluid.walls.reports() || fluid.walls.curves)
    held_ = fluid.particles.add<Vec3f>({.name = "held",
                                        .unit = "m",
                                        .doc = "The displacement by walls, in the last step.",
                                        .internal = true});
  if (hasMomentum()) fitScratch(fluid, plain_);
  if (hasMomentum() && walls) fitScratch(fluid, plainShare_);
  PressureSolver::reserve(fluid, controlled() && !conjugates());
}

double AcceleratedSolver::memory(const FluidRoom& room) const {
  // What reserve() fits, and the attribute of reset().
  const double n = room.particles;
  double bytes = PressureSolver::memory(room);
  if (conjugates())
    bytes += directions_.memoryFor(n, room.wallShares, room.boundaryForces || room.solids > 0);
  if (hasMomentum()) bytes += bytesOfArrays(n, plain_);
  if (hasMomentum() && room.solids > 0) bytes += bytesOfArrays(n, plainShare_);
  if (controlled() && !conjugates() && !searches()) bytes += bytesOfArrays(n, excess_);
  if (room.boundaryForces || (conjugates() && room.solids > 0))
    bytes += ParticleSet::memoryOfAttribute(n, AttributeType::kVec3);
  if (carries()) bytes += ParticleSet::memoryOfAttribute(n, AttributeType::kVec3);
  return bytes;
}

detail::GainTolerance AcceleratedSolver::gainTolerance(const PressureProblem& problem) const {
  // Of the energy of a fluid that is compressed by the tolerance.
  constexpr double kOfBulk = 0.05;
  const double dt = problem.fluid.time.dt, sinks = double(length(problem.fluid.time.gravity)) * dt * dt;
  return {.bulk = kOfBulk * double(problem.stiffness()) *
                  double(bulkEnergy_.value(tolerance.get().value_or(0.0f))),
          .weight = 0.5 * sinks * sinks};
}

detail::Settle AcceleratedSolver::settleOf(const PressureProblem& problem, bool first) {
  return {.density = detail::RelativeExcess::of(problem),
          .control = control_->data(),
          .of = conjugateView(),
          .energy = bulkEnergy_,
          .tension = tension,
          .first = first,
          .displacement = problem.displacement(),
          .weighted = problem.weighted()};
}

Contain AcceleratedSolver::containOf(const PressureProblem& problem, ArrayView<Vec3f> displacement,
                                     const int* done, ArrayView<Vec3f> held) {
  return {.boundary = problem.fluid.walls.boundary.boundary,
          .radius = problem.fluid.constants.contact,
          .predicted = problem.predicted(),
          .displacement = displacement,
          .state = problem.state(),
          .held = held,
          .done = done};
}

detail::Judge AcceleratedSolver::judgeOf(const PressureProblem& problem, const SolverSums* sums, bool last) {
  constexpr double kReach = 0.25, kNear = 0.1;  // spacings
  const double reach = kReach * problem.fluid.constants.spacing;
  const double near = kNear * problem.fluid.constants.spacing;
  return {.control = control_->data(),
          .sums = sums,
          .count = all_,
          .tolerance = double(tolerance.get().value_or(-1.0f)),
          .gainTolerance = gainTolerance(problem),
          .accelerated = accelerated(),
          .farthest = reach * reach,
          .nearest = neighborSearches.get() ? -1 : near * near,
          .maxRepeats = maxRepeats(),
          .maxIterations = maxRepeats() > 0 ? maxIterations : std::numeric_limits<int>::max(),
          .passes = passes(),
          .last = last};
}

void AcceleratedSolver::report(NodeReport& report) {
  PressureSolver::report(report);
  Value& used = report.statistics["solver_iterations"];
  used = maxIterations.get();
  if (!tolerance.get() || control_->size() == 0) return;
  const Control control = control_->toHost().front();
  used = Value::object();
  used["mean"] =
      control.steps > 0 ? static_cast<double>(control.total) / static_cast<double>(control.steps) : 0.0;
  used["max"] = control.max;
  used["last"] = control.iterations;
  const std::int64_t notConverged = control.notConverged + (control.met || control.steps == 0 ? 0 : 1);
  used["not_converged"] = notConverged;
  // From here on `used` may refer to nothing, as the statistics grow.
  Value& stages = report.statistics["solver_stages"];
  stages = Value::object();
  stages["mean"] =
      control.steps > 0 ? static_cast<double>(control.staged) / static_cast<double>(control.steps) : 0.0;
  stages["max"] = control.maxStages;
  report.events.push_back({"steps ended with more compression than the solver's tolerance", notConverged});
}

}  // namespace weir
