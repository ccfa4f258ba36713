#include "nodes/particle_fluid/pressure_solver.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/graph/setting_warning.h"
#include "nodes/particle_fluid/scratch.h"
#include "nodes/particle_fluid/step_length.h"

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

void PressureSolver::validate() const {
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

void PressureSolver::reset(FluidStep& fluid) {
  bulkEnergy_ = BulkEnergy(coefficientsOf(energy, polynomial));
  sums_ = Array<SolverSums>(fluid.device);
  sums_.resize(1);
}

void PressureSolver::report(NodeReport& report) {
  if (recordObjective) objective_->report(report);
}

double PressureSolver::memory(const FluidRoom& room) const {
  const double n = room.particles;
  return bytesOfArray(n, sizeof(Vec4f))  // PressureProblem::state()
         + (searches() ? bytesOfArrays(n, proposal_, excess_) : 0);
}

PressureProblem PressureSolver::problemOf(FluidStep& fluid) const {
  return {.fluid = fluid, .energy = bulkEnergy_, .conservative = conservative, .tension = tension};
}

StepOf PressureSolver::stepOf(const PressureProblem& problem, ArrayView<const Vec3f> searched) const {
  const Measure measure{.energy = bulkEnergy_,
                        .stiffness = problem.stiffness(),
                        .displacement = problem.displacement(),
                        .excess = excess_.view(),
                        .proposal = searches() ? proposal_.view() : ArrayView<const Vec4f>{},
                        .searched = searched};
  return {.pushOf = problem.push(), .length = stepLength, .measure = measure, .sums = sums_.data()};
}

void PressureSolver::reserve(FluidStep& fluid, bool excess) {
  if (searches()) fitScratch(fluid, proposal_);
  if (searches() || excess) fitScratch(fluid, excess_);
}

void PressureSolver::record(const PressureProblem& problem) {
  if (recordObjective)
    objective_->measure(problem.fluid, bulkEnergy_, tension, problem.state(), problem.displacement());
}

void PressureSolver::warnOfFew(const FluidOutlook& outlook, int iterations,
                               const std::string& another) const {
  const FluidConstants& c = outlook.constants;
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
                  number, 100 * expected, iterations),
      fmt::format("a world.dt of at most {:.2g} s, or {:.0f} iterations, or {}",
                  outlook.dt * std::sqrt(goodRatio * iterations / number), std::ceil(number / goodRatio),
                  another));
}

}  // namespace weir
