// The recorded objective against the same function in double precision, over all pairs.
#include "nodes/particle_fluid/objective.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.01f;
constexpr double kDt = 2e-3;

/// ψ by iteration of one step of a solver with these parameters; the particles' new places in `end`.
std::vector<double> objectives(Device& device, const std::vector<Vec3f>& positions, const char* type,
                               Value solver, std::vector<Vec3f>& end) {
  solver["record_objective"] = true;
  FluidScene scene(device, positions, {},
                   object({{"spacing", kSpacing}, {"calibration", "lattice"}, {"mu", 1.0}}),
                   object({{"solver", object({{"type", type}, {"params", std::move(solver)}})},
                           {"viscosity", object({{"params", object({{"rate", 0.0}})}})}}));
  scene.gravity = {};
  scene.reset(kDt);
  scene.step();
  end = scene.positions();
  std::vector<double> found;
  const Value statistics = scene.report().statistics;
  for (const Value& v : statistics.find("objective_by_iteration")->asArray()) found.push_back(v.asDouble());
  return found;
}

using Energy = double (*)(double lambda);
double b0(double l) {
  return (l - 1) * (l - 1) / 2;
}
double b2(double l) {
  return (std::pow(l, 4) - 1) / 4 - l + 1;
}

/// Eq. 7 in joules, of particles that came from `start`, whose neighbours stay those of the start.
double expectedObjective(const std::vector<Vec3f>& positions, const std::vector<Vec3f>& start,
                         Energy energy) {
  ReferenceFluid reference{.spacing = kSpacing, .supportRatio = 1.5, .dt = kDt};
  for (const Vec3f& p : start) reference.positions.push_back(toDouble(p));
  const std::vector<std::vector<int>> neighbors = reference.neighbors();
  double sum = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    double density = reference.kernel(0);
    for (const int j : neighbors[i])
      density += reference.kernel(length(toDouble(positions[std::size_t(j)]) - toDouble(positions[i])));
    const Vec3d u = toDouble(positions[i]) - toDouble(start[i]);
    const double mass = reference.restDensity * reference.volume();
    sum += mass / (2 * kDt * kDt) * dot(u, u) +
           reference.mu * energy(std::max(reference.volume() * density, 1.0));
  }
  return sum;
}

TEST(ObjectiveRecord, AgreesWithDoublePrecisionAfterEveryIteration) {
  const std::vector<Vec3f> start = jitteredCube(8, kSpacing, 0.2f, 3);
  struct Case {
    const char* type;
    Value solver;
    Energy energy;
  };
  const Case cases[] = {
      {"SemiImplicitSolver", object({}), b0},
      {"SemiImplicitSolver", object({{"energy", "b2"}, {"step_length", "particle"}}), b2},
      {"AcceleratedSolver", object({{"tolerance", 1e-6}, {"acceleration", "none"}, {"neighbor_searches", 1}}),
       b0},
      {"Pbf", object({}), b0}};
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const Case& c : cases) {
      SCOPED_TRACE(name + ", " + c.type);
      std::vector<Vec3f> end;
      for (const int iterations : {1, 4}) {
        Value solver = c.solver;
        solver[c.type == std::string("AcceleratedSolver") ? "max_iterations" : "iterations"] = iterations;
        const std::vector<double> psi = objectives(*device, start, c.type, solver, end);
        ASSERT_EQ(psi.size(), std::size_t(iterations + 1));
        const double before = expectedObjective(start, start, c.energy);
        EXPECT_NEAR(psi.front() / before, 1, 1e-5);
        EXPECT_NEAR(psi.back() / expectedObjective(end, start, c.energy), 1, 1e-4);
        EXPECT_GT(std::abs(psi.back() - before), 0.1 * before);
      }
    }
  }
}

TEST(ObjectiveRecord, IsOfTheLastStepAloneAndOnlyWhereItIsAskedFor) {
  const auto device = openDevice("cpu");
  for (const bool asked : {false, true}) {
    FluidScene scene(*device, jitteredCube(5, kSpacing, 0.2f, 3), {}, object({{"spacing", kSpacing}}),
                     object({{"solver", object({{"params", object({{"record_objective", asked}})}})}}));
    scene.reset(kDt);
    scene.step(7);
    const Value statistics = scene.report().statistics;
    const Value* list = statistics.find("objective_by_iteration");
    ASSERT_EQ(list != nullptr, asked);
    if (asked) {
      EXPECT_EQ(list->asArray().size(), 4u);
    }
  }
}

}  // namespace
}  // namespace weir::test
