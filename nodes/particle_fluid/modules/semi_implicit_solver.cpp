#include "nodes/particle_fluid/modules/semi_implicit_solver.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/graph/setting_warning.h"
#include "nodes/particle_fluid/scratch.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

std::vector<float> coefficientsOf(EnergyName name, const std::vector<float>& polynomial) {
  switch (name) {
    case EnergyName::kB0:
      return {1};
    case EnergyName::kB1:
      return {0, 1};
    case EnergyName::kB2:
      return {0, 0, 1};
    case EnergyName::kPolynomial:
      break;
  }
  return polynomial;
}

}  // namespace

void SemiImplicitSolver::validate() const {
  if (energy != EnergyName::kPolynomial) {
    if (!polynomial->empty())
      throw sceneError("coefficients are given, but the energy is not \"polynomial\"",
                       "no coefficients, or \"energy\": \"polynomial\"")
          .inParameter(polynomial.name());
    return;
  }
  float sum = 0;
  for (const float c : polynomial.get()) sum += c;
  if (!(sum > 0) || polynomial->size() > std::size_t{BulkEnergy::kMaxTerms})
    throw sceneError("found " + polynomial.value().brief() + " for the polynomial",
                     "1 to " + std::to_string(BulkEnergy::kMaxTerms) + " coefficients, one of them above 0")
        .inParameter(polynomial.name());
}

void SemiImplicitSolver::reset(FluidStep& fluid) {
  bulkEnergy_ = BulkEnergy(coefficientsOf(energy, polynomial));
  control_ = Array<Control>(fluid.device);
  control_->assign(std::vector<Control>{Control{}});
  sums_ = Array<Sums>(fluid.device);
  sums_.resize(1);
  farthest_ = Array<float>(fluid.device);
  farthest_.resize(1);
  controlSeen_.emplace(fluid.device);
  passes_ = 0;
  mixing_.release();
  carried_ = carries() ? &fluid.particles.add<Vec3f>({"displacement", AttributeType::kVec3, "m",
                                                      "By pressure and walls, at the last search in a step."})
                       : nullptr;
}

void SemiImplicitSolver::warn(const FluidOutlook& outlook) const {
  const FluidConstants& c = outlook.constants;
  if (tolerance.get()) {
    // The mean over a column of depth h, at rest: ρ0·g·h/(2·K').
    const double atRest = 0.5 * outlook.pressure / c.bulkModulus;
    if (atRest > *tolerance.get() * (1 + kSettingRounding))
      outlook.warn(*this,
                   fmt::format("a tolerance of {:.3g} cannot be met: at rest the fluid's mean compression is "
                               "{:.3g}, from its weight and bulk_modulus",
                               *tolerance.get(), atRest),
                   fmt::format("a tolerance of at least {:.2g}, or a bulk_modulus of at least {:.2g} Pa",
                               atRest, 0.5 * outlook.pressure / *tolerance.get()));
    return;
  }
  // Measured in dam breaks: a mean compression of about 0.01·(S/iterations)^0.8, with S of the fluid that was
  // asked for: one that is stiffened because λ hardly tells its compression is compressed, by λ, no more.
  constexpr double kOfOne = 0.01, kExponent = 0.8, kMax = 0.05;
  const double courant = std::sqrt(c.soundSpeedSquared()) * outlook.dt / c.spacing;
  const double number = courant * courant / c.stiffened;
  const double expected = kOfOne * std::pow(number / iterations, kExponent);
  if (expected <= kMax * (1 + kSettingRounding)) return;
  const double goodRatio = std::pow(kMax / kOfOne, 1 / kExponent);
  outlook.warn(
      *this,
      fmt::format("S = (c·dt/d)² = {:.3g} leaves a mean compression of about {:.2g} % after {} iterations",
                  number, 100 * expected, iterations.get()),
      fmt::format("a world.dt of at most {:.2g} s, or {:.0f} iterations, or a tolerance",
                  outlook.dt * std::sqrt(goodRatio * iterations / number), std::ceil(number / goodRatio)));
}

bool SemiImplicitSolver::isDone() {
  if (!tolerance.get()) return false;
  const std::optional<Control> seen = controlSeen_->poll();
  if (!seen || seen->passes != passes_) return false;
  over_ = seen->over != 0;
  return seen->done != 0;
}

void SemiImplicitSolver::endPass(int pass) {
  if (!tolerance.get() || pass + 1 < passes()) return;
  if (controlSeen_->pending()) controlSeen_->wait();
  controlSeen_->request(control_->data());
  over_ = controlSeen_->wait().over != 0;
}

bool SemiImplicitSolver::staged(const FluidStep& fluid) const {
  return tolerance.get() && pathStages > 1 && fluid.walls.empty();
}

int SemiImplicitSolver::maxRepeats() const {
  constexpr int kMax = 10;
  return tolerance.get() && !neighborSearches.get() ? kMax : 0;
}

int SemiImplicitSolver::maxPasses() const {
  // One may be idle, see BeginPass.
  return tolerance.get() ? 1 + pathStages * (1 + maxRepeats()) + passes() : passes();
}

void SemiImplicitSolver::reserve(FluidStep& fluid) {
  if (mixes()) mixing_.reserve(fluid.device, fluid.particles.positions().size(), !fluid.walls.empty());
  if (accelerated() && !mixes()) fitScratch(fluid, plain_);
  if (accelerated() && !mixes() && !fluid.walls.empty()) fitScratch(fluid, plainShare_);
  if (searches()) fitScratch(fluid, proposal_);
  if (controlled() || searches()) fitScratch(fluid, excess_);
}

double SemiImplicitSolver::memory(const FluidRoom& room) const {
  // What reserve() fits, and the attribute of reset().
  const double n = room.particles;
  double bytes = bytesOfArray(n, sizeof(Vec4f));  // places()
  if (mixes()) bytes += mixing_.memoryFor(n, room.solids > 0);
  if (accelerated() && !mixes()) bytes += bytesOfArrays(n, plain_);
  if (accelerated() && !mixes() && room.solids > 0) bytes += bytesOfArrays(n, plainShare_);
  if (searches()) bytes += bytesOfArrays(n, proposal_);
  if (controlled() || searches()) bytes += bytesOfArrays(n, excess_);
  if (carries()) bytes += ParticleSet::memoryOfAttribute(n, AttributeType::kVec3);
  return bytes;
}

void SemiImplicitSolver::record(FluidStep& fluid) {
  if (recordObjective)
    objective_->measure(fluid, bulkEnergy_, tension, fluid.particles.places().view(),
                        fluid.particles.scratch().view());
}

void SemiImplicitSolver::report(NodeReport& report) {
  if (recordObjective) objective_->report(report);
  Value& used = report.statistics["solver_iterations"];
  used = iterations.get();
  if (!tolerance.get() || control_->size() == 0) return;
  const Control control = control_->toHost().front();
  used = Value::object();
  used["mean"] =
      control.steps > 0 ? static_cast<double>(control.total) / static_cast<double>(control.steps) : 0.0;
  used["max"] = control.most;
  used["last"] = control.iterations;
  const std::int64_t unmet = control.unmet + (control.met || control.steps == 0 ? 0 : 1);
  used["unmet"] = unmet;
  // From here on `used` may refer to nothing, as the statistics grow.
  Value& stages = report.statistics["solver_stages"];
  stages = Value::object();
  stages["mean"] =
      control.steps > 0 ? static_cast<double>(control.staged) / static_cast<double>(control.steps) : 0.0;
  stages["max"] = control.mostStages;
  report.events.push_back({"steps ended with more compression than the solver's tolerance", unmet});
}

}  // namespace weir
