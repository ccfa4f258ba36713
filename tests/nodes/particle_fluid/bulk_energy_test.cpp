// Bulk energies, step lengths, tolerance and acceleration of the solver.
#include "nodes/particle_fluid/bulk_energy.h"

#include <gtest/gtest.h>

#include "nodes/particle_fluid/modules/accelerated_solver.h"
#include "nodes/particle_fluid/modules/semi_implicit_solver.h"
#include "tests/nodes/particle_fluid/siisph_reference.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

std::vector<Vec3d> toDouble(const std::vector<Vec3f>& vectors) {
  std::vector<Vec3d> result;
  for (const Vec3f& v : vectors) result.push_back(toDouble(v));
  return result;
}

/// A fluid whose solver has these parameters, calibrated to a lattice.
FluidScene fluidWith(Device& device, const std::vector<Vec3f>& positions, float spacing, Value solver,
                     std::pair<const char*, Value> stiffness = {"mu", 1.0},
                     const char* type = "SemiImplicitSolver") {
  return FluidScene(device, positions, {},
                    object({{"spacing", spacing}, {"calibration", "lattice"}, stiffness}),
                    object({{"solver", object({{"type", type}, {"params", std::move(solver)}})},
                            {"viscosity", object({{"params", object({{"rate", 0.0}})}})}}));
}

TEST(BulkEnergy, IsThePapersAndItsDerivativeIsItsDerivative) {
  const auto check = [](const std::vector<float>& coefficients, auto value, auto derivative) {
    const BulkEnergy energy(coefficients);
    for (const double l : {0.8, 0.99, 1.0, 1.001, 1.1, 1.5}) {
      EXPECT_NEAR(energy.value(float(l - 1)), value(l), 2e-6) << l;
      EXPECT_NEAR(energy.derivative(float(l - 1)), derivative(l), 2e-6) << l;
    }
  };
  check(
      {1}, [](double l) { return (l - 1) * (l - 1) / 2; }, [](double l) { return l - 1; });
  check(
      {0, 1}, [](double l) { return (l * l * l - 1) / 3 - l + 1; }, [](double l) { return l * l - 1; });
  check(
      {0, 0, 1}, [](double l) { return (l * l * l * l - 1) / 4 - l + 1; },
      [](double l) { return l * l * l - 1; });
  check(
      {0.5f, 0, 0, 2},
      [](double l) { return (l * l - 1) / 4 - (l - 1) / 2 + 2 * ((std::pow(l, 5) - 1) / 5 - l + 1); },
      [](double l) { return 0.5 * (l - 1) + 2 * (std::pow(l, 4) - 1); });
  EXPECT_EQ(BulkEnergy({0.5f, 0, 0, 2}).negativePart(), 2.5f);
}

struct EnergyCase {
  const char* name;
  std::vector<double> coefficients;
};
const EnergyCase kEnergies[] = {
    {"b0", {1}}, {"b1", {0, 1}}, {"b2", {0, 0, 1}}, {"polynomial", {0.5, 0, 1, 0.25}}};

Value solverOf(const EnergyCase& energy, const char* stepLength, int iterations) {
  Value v = object({{"energy", energy.name}, {"step_length", stepLength}, {"iterations", iterations}});
  if (std::string_view(energy.name) == "polynomial") {
    v["polynomial"] = Value::array();
    for (const double c : energy.coefficients) v["polynomial"].push(c);
  }
  return v;
}

TEST(SolverEnergies, OneStepAgreesWithDoublePrecision) {
  using Length = ReferenceFluid::StepLength;
  constexpr float kSpacing = 0.01f;
  constexpr double kDt = 2e-3;
  const std::vector<Vec3f> positions = jitteredCube(9, kSpacing, 0.2f, 7);
  for (const EnergyCase& energy : kEnergies) {
    for (const auto& [name, length] :
         {std::pair{"full", Length::kFull}, {"particle", Length::kParticle}, {"global", Length::kGlobal}}) {
      SCOPED_TRACE(std::string(energy.name) + ", " + name);
      ReferenceFluid reference{.spacing = kSpacing, .supportRatio = 1.5, .dt = kDt};
      reference.energy = energy.coefficients;
      reference.stepLength = length;
      reference.positions = toDouble(positions);
      reference.velocities.resize(positions.size());
      reference.step();
      for (const std::string& device : availableDevices()) {
        const auto machine = openDevice(device);
        FluidScene scene = fluidWith(*machine, positions, kSpacing, solverOf(energy, name, 3));
        scene.reset(kDt);
        scene.step();
        double largest = 0;
        const std::vector<Vec3f> found = scene.positions();
        for (std::size_t i = 0; i < found.size(); ++i)
          largest = std::max(largest, weir::length(toDouble(found[i]) - reference.positions[i]));
        EXPECT_LT(largest / kSpacing, 1e-4) << device;
      }
    }
  }
}

TEST(SolverEnergies, TheObjectiveFallsInEveryIterationOfASearch) {
  constexpr float kSpacing = 0.01f;
  constexpr double kDt = 1e-3;
  const std::vector<Vec3f> positions = jitteredCube(8, kSpacing, 0.2f, 3);
  const auto device = openDevice("cpu");
  for (const EnergyCase& energy : kEnergies) {
    for (const char* length : {"particle", "global"}) {
      ReferenceFluid reference{.spacing = kSpacing, .supportRatio = 1.5, .dt = kDt};
      reference.energy = energy.coefficients;
      double last = std::numeric_limits<double>::infinity(), first = 0;
      for (int iterations = 1; iterations <= 50; ++iterations) {
        FluidScene scene = fluidWith(*device, positions, kSpacing, solverOf(energy, length, iterations));
        scene.gravity = {};
        scene.reset(kDt);
        scene.step();
        reference.positions = toDouble(scene.positions());
        const double now = reference.objective(toDouble(positions));
        // Positions are floats: the last digits of the objective are noise.
        EXPECT_LT(now, last * (1 + 1e-5)) << energy.name << ", " << length << ", iteration " << iterations;
        if (iterations == 1) first = now;
        last = now;
      }
      EXPECT_LT(last, 0.9 * first) << energy.name;
    }
  }
}

/// Mean of max(λ − 1, 0), in double precision.
double meanCompression(const std::vector<Vec3f>& positions, double spacing) {
  ReferenceFluid reference{.spacing = spacing, .supportRatio = 1.5};
  reference.positions = toDouble(positions);
  double sum = 0;
  for (const double lambda : reference.relativeDensities()) sum += std::max(lambda - 1, 0.0);
  return sum / double(positions.size());
}

TEST(SolverTolerance, IsMetAndNoFurtherIterationIsMade) {
  constexpr float kSpacing = 0.04f;
  constexpr double kDt = 1e-2;
  const std::vector<Vec3f> positions = jitteredCube(9, kSpacing, 0.2f, 7);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const char* const accelerations[] = {"none", "nesterov", "conjugate"};
    int counts[3] = {};
    for (int k = 0; k < 3; ++k) {
      Value solver = object({{"max_iterations", 2000}, {"tolerance", 0.004}, {"neighbor_searches", 1}});
      solver["acceleration"] = accelerations[k];
      FluidScene scene =
          fluidWith(*device, positions, kSpacing, solver, {"bulk_modulus", 1e6}, "AcceleratedSolver");
      scene.gravity = {};
      scene.reset(kDt);
      scene.step();
      // The neighbours are those of the step's beginning, and stay all there are at this tolerance.
      EXPECT_LT(meanCompression(scene.positions(), kSpacing), 0.0041) << name;
      const Value used = scene.report().statistics["solver_iterations"];
      const int count = int(used.find("last")->asInt());
      EXPECT_GT(count, 3) << name;
      EXPECT_LT(count, 2000) << name;
      counts[k] = count;
      // Conjugate gradients go on until particles have come to rest, too.
      if (k == 2) continue;
      // One iteration less does not meet it.
      solver["max_iterations"] = count - 1;
      FluidScene shorter =
          fluidWith(*device, positions, kSpacing, solver, {"bulk_modulus", 1e6}, "AcceleratedSolver");
      shorter.gravity = {};
      shorter.reset(kDt);
      shorter.step();
      EXPECT_GT(meanCompression(shorter.positions(), kSpacing), 0.004) << name;
    }
    std::printf("iterations to 0.4 %% on %s: %d plain, %d with momentum, %d conjugate\n", name.c_str(),
                counts[0], counts[1], counts[2]);
    for (int k = 1; k < 3; ++k) EXPECT_LT(counts[k], counts[0]) << name;
  }
}

TEST(SolverParameters, SayWhatIsWrong) {
  SemiImplicitSolver solver;
  const auto refused = [&](Value v) { return std::string(errorOf([&] { solver.assignAll(v, {}); }).what()); };
  EXPECT_CONTAINS(refused(object({{"energy", "b3"}})), "\"b0\", \"b1\", \"b2\" or \"polynomial\"");
  EXPECT_CONTAINS(refused(object({{"energy", "polynomial"}})), "1 to 8 coefficients");
  EXPECT_CONTAINS(refused(object({{"polynomial", Value::Array{1}}})), "not \"polynomial\"");
  EXPECT_CONTAINS(refused(object({{"energy", "polynomial"}, {"polynomial", Value::Array{1, -1}}})), "-1");
  EXPECT_CONTAINS(refused(object({{"tolerance", 0.1}})), "no parameter 'tolerance'");
  AcceleratedSolver accelerated;
  const auto refusedBy = [&](Value v) {
    return std::string(errorOf([&] { accelerated.assignAll(v, {}); }).what());
  };
  EXPECT_CONTAINS(refusedBy(object({{"tolerance", 0.0}})), "tolerance");
  EXPECT_CONTAINS(refusedBy(object({{"iterations", 3}})), "max_iterations");
  EXPECT_CONTAINS(refusedBy(object({{"acceleration", "conjugate"}, {"conservative", false}})),
                  "another acceleration");
  EXPECT_CONTAINS(refusedBy(object({{"acceleration", "conjugate"}, {"step_length", "global"}})),
                  "another acceleration");
}

}  // namespace
}  // namespace weir::test
