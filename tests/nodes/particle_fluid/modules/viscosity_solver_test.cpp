// Viscosity in Pa·s against closed forms, its conservation laws, and its parameters.
#include "nodes/particle_fluid/modules/viscosity_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "framework/compute/cpu_threads.h"
#include "framework/particles/relaxed_tile.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kSpacing = 0.01f;

/// A fluid with viscosity, and without XSPH.
Value viscous(Value params) {
  return object({{"viscosity", disabled()}, {"viscous", inserted("ViscositySolver", "walls", params)}});
}

/// A cylinder about the y axis from y = 0 on, as fluid lies that has been at rest.
std::vector<Vec3f> cylinder(double supportRatio, double radius, double length, double spacing) {
  CpuThreads threads(2);
  const RelaxedTile tile(supportRatio, 12, 300, 1, threads);
  const int reach = int(std::ceil(radius / spacing)) + 1, layers = int(std::ceil(length / spacing)) + 1;
  std::vector<Vec3f> positions;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -1; y <= layers; ++y)
      for (int z = -reach; z <= reach; ++z) {
        const Vec3f u = tile.displacement(x, y, z);
        const Vec3d p = spacing * Vec3d{x + double(u.x), y + double(u.y), z + double(u.z)};
        if (p.x * p.x + p.z * p.z < radius * radius && p.y > 0 && p.y < length)
          positions.push_back({float(p.x), float(p.y), float(p.z)});
      }
  return positions;
}

std::vector<Vec3d> toDoubles(const std::vector<Vec3f>& vectors) {
  std::vector<Vec3d> all;
  for (const Vec3f& v : vectors) all.push_back(toDouble(v));
  return all;
}

/// By viscosity in the last step, in the order of the ids.
std::vector<Vec3f> changes(FluidScene& scene) {
  const ParticleSet& particles = scene.fluid().fluid->set();
  const std::int64_t n = particles.bound();
  const std::vector<std::int64_t> ids = particles.ids().toHost(n);
  const std::vector<Vec3f> all = particles.get<Vec3f>("viscous_change").toHost(n);
  std::vector<Vec3f> byId(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) byId[std::size_t(ids[i])] = all[i];
  return byId;
}

/// A free cylinder of fluid whose slices turn against each other, v = Ω·cos(k·y)·(−z, 0, x), k = π/L. Neither
/// its ends nor its side feel a stress, and it decays as exp(−ν·k²·t), whatever its radius.
struct Torsion {
  double spacing, viscosity, dt;
  int steps;
  bool pressure = true;
};

constexpr double kRadius = 0.06, kLength = 0.12, kWave = kPi / kLength, kDensity = 1000;

/// The rate of decay over ν·k².
double decayOfTorsion(Device& device, const Torsion& t) {
  constexpr double kTurning = 5;
  const std::vector<Vec3f> positions = cylinder(2, kRadius, kLength, t.spacing);
  std::vector<Vec3f> velocities;
  for (const Vec3f& p : positions) {
    const double turning = kTurning * std::cos(kWave * p.y);
    velocities.push_back({float(-turning * p.z), 0, float(turning * p.x)});
  }
  Value modules = viscous(object({{"viscosity", t.viscosity}}));
  if (!t.pressure) modules["solver"] = disabled();
  FluidScene scene(device, positions, velocities, object({{"spacing", t.spacing}, {"support_ratio", 2.0}}),
                   modules);
  scene.gravity = {};
  const auto twist = [&](const std::vector<Vec3f>& v) {
    const std::vector<Vec3f> x = scene.positions();
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      sum += (double(x[i].x) * v[i].z - double(x[i].z) * v[i].x) * std::cos(kWave * x[i].y);
    return sum;
  };
  scene.reset(t.dt);
  const double before = twist(scene.velocities());
  scene.step(t.steps);
  // Implicit steps multiply by 1/(1 + ν·k²·dt), each; of slow decay only the change is more than rounding.
  double growth = -twist(changes(scene)) / before;
  if (growth > 1e-3) growth = std::pow(before / twist(scene.velocities()), 1.0 / t.steps) - 1;
  return growth / (t.viscosity / kDensity * kWave * kWave * t.dt);
}

TEST(ViscositySolver, TwistedCylinderLosesItsMotionAtTheRateOfTheClosedForm) {
  // A quarter of a spacing below a free surface has too few neighbours to carry its stress, so a cylinder of
  // n spacings' radius is too soft by 1/n, and by nothing in the limit.
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const auto& [viscosity, dt, steps, pressure] : {std::tuple{0.001, 1e-3, 1, false},
                                                         {10.0, 1e-3, 4, true},
                                                         {10.0, 2.5e-4, 8, true},
                                                         {1e4, 1e-3, 1, true},
                                                         {1e4, 1e-4, 1, true}}) {
      double rate[2];
      for (const int fine : {0, 1})
        rate[fine] = decayOfTorsion(*device, {fine == 0 ? 0.01 : 0.005, viscosity, dt, steps, pressure});
      const double limit = 2 * rate[1] - rate[0];
      std::printf("twisted cylinder on %s, %g Pa·s, dt %g s: %.4f and %.4f of the closed form, limit %.4f\n",
                  name.c_str(), viscosity, dt, rate[0], rate[1], limit);
      EXPECT_GT(rate[0], 0.8);
      EXPECT_GT(rate[1], 0.9);
      // Without time to give way, velocities are those of the mean flow, and settled fluid seems stiffer.
      EXPECT_NEAR(limit, pressure ? 1.0 : 1.02, 0.035);
    }
  }
}

/// Σ v, Σ x × v and Σ v²/2.
struct Conserved {
  Vec3d momentum, turning;
  double energy = 0;
};
Conserved conservedOf(const FluidScene& scene) {
  const std::vector<Vec3f> x = scene.positions(), v = scene.velocities();
  Conserved c;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3d at = toDouble(x[i]), u = toDouble(v[i]);
    c.momentum += u;
    c.turning += cross(at, u);
    c.energy += 0.5 * dot(u, u);
  }
  return c;
}

TEST(ViscositySolver, KeepsMomentumAndAngularMomentumWhateverTheTolerance) {
  const std::vector<Vec3f> positions = jitteredCube(10, kSpacing, 0.2f, 3);
  const std::vector<Vec3f> velocities = randomVelocities(positions.size(), 0.5f, 4);
  const double n = double(positions.size());
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const double viscosity : {0.001, 1.0, 100.0, 1e4})
      for (const double tolerance : {1e-4, 0.1}) {
        Value modules = viscous(object({{"viscosity", viscosity}, {"tolerance", tolerance}}));
        modules["solver"] = disabled();
        FluidScene scene(*device, positions, velocities, object({{"support_ratio", 2.0}}), modules);
        scene.gravity = {};
        scene.reset(1e-3);
        Conserved before = conservedOf(scene);
        const Conserved first = before;
        for (int step = 0; step < 5; ++step) {
          scene.step();
          const Conserved after = conservedOf(scene);
          EXPECT_LE(after.energy, before.energy * (1 + 1e-6)) << name << ", " << viscosity;
          before = after;
        }
        const double drift = length(before.momentum - first.momentum) / n,
                     turn = length(before.turning - first.turning) / n;
        std::printf("%g Pa·s, tolerance %g: %.2g m/s of momentum, %.2g m²/s of angular momentum gained\n",
                    viscosity, tolerance, drift, turn);
        // Rounding of forces that are up to 1e4 times what they leave; of 0.24 m/s and 0.012 m²/s.
        EXPECT_LT(drift, 3e-6) << name << ", " << viscosity;
        EXPECT_LT(turn, tolerance < 0.01 ? 3e-7 : 1e-6) << name << ", " << viscosity;
        if (viscosity > 10) {
          EXPECT_LT(before.energy, 0.05 * first.energy) << name;
        }
      }
  }
}

TEST(ViscositySolver, RigidMotionFeelsNothing) {
  const std::vector<Vec3f> positions = jitteredCube(8, kSpacing, 0.2f, 3, {0.02f, 0.01f, 0});
  std::vector<Vec3f> velocities;
  for (const Vec3f& p : positions) velocities.push_back(Vec3f{3, 1, 0} + cross(Vec3f{0, 2, 1}, p));
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    Value modules = viscous(object({{"viscosity", 1e4}}));
    modules["solver"] = disabled();
    FluidScene scene(*device, positions, velocities, object({{"support_ratio", 2.0}}), modules);
    scene.gravity = {};
    scene.reset(1e-4);
    scene.step();
    EXPECT_LT(largestDifference(scene.velocities(), toDoubles(velocities)), 3e-6) << name;
  }
}

/// A film on a floor, with a body force along it. Its ends are free, and too far from its middle to be felt
/// there.
constexpr const char* kFilm = R"({"weir": 1,
  "world": {"gravity": [2, -2, 0], "dt": 0.001, "frame_rate": 10, "duration": 1},
  "nodes": {
    "film": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.6, 0.06, 0.03]}},
    "left": {"type": "StaticBoundary", "params": {"shape": "plane", "normal": [0, 0, 1], "slip": 1}},
    "right": {"type": "StaticBoundary",
              "params": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 0.03], "slip": 1}},
    FLOOR,
    "honey": {"type": "ParticleFluid", "params": {"spacing": 0.01, "rest_steps": 1000},
              "modules": {"solver": {"type": "SemiImplicitSolver"}, "viscosity": {"enabled": false},
                          "viscous": {"type": "ViscositySolver", "after": "walls"}}}},
  "links": ["film.particles -> honey.initial", "left.boundary -> honey.boundaries",
            "right.boundary -> honey.boundaries", LINKS]})";

struct Film {
  bool mesh;
  double viscosity;
  int steps;  // of 1 ms
  double slip = 0;
  double supportRatio = 2;
};

/// Mean velocity along the floor in the middle of the film, m/s.
double flowOfFilm(Device& device, const Film& film) {
  const char* const nodes =
      film.mesh ? R"("ground": {"type": "BoxMesh", "params": {"min": [-1, -1, -1], "max": [2, 0, 1]}},
                     "floor": {"type": "SemiAnalyticalSFI"})"
                : R"("floor": {"type": "StaticBoundary", "params": {"shape": "plane"}})";
  const char* const links = film.mesh ? R"("ground.surface -> floor.solids", "honey.fluid -> floor.fluid")"
                                      : R"("floor.boundary -> honey.boundaries")";
  std::string text = kFilm;
  text.replace(text.find("FLOOR"), 5, nodes);
  text.replace(text.find("LINKS"), 5, links);
  SimulatedScene scene(device, text,
                       {"honey.viscous.viscosity=" + std::to_string(film.viscosity),
                        "honey.support_ratio=" + std::to_string(film.supportRatio),
                        "floor.slip=" + std::to_string(film.slip)});
  scene->reset();
  for (int k = 0; k < film.steps; ++k) scene->step();
  ParticleSet& particles = scene.node<ParticleFluid>("honey").fluid->set();
  const std::int64_t n = particles.refreshCount();
  const std::vector<Vec3f> x = particles.positions().toHost(n), v = particles.velocities().toHost(n);
  double sum = 0;
  int there = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::abs(x[i].x - 0.3f) < 0.05f) sum += double(v[i].x), ++there;
  return sum / there;
}

TEST(ViscositySolver, AFilmThatSticksFlowsAsNusseltsAndOneThatGlidesFalls) {
  constexpr double kDepth = 0.06, kPull = 2;
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const bool mesh : {false, true}) {
      constexpr double kViscosity = 1e3;
      const double nusselt = kDensity * kPull * kDepth * kDepth / (3 * kViscosity),
                   ratio = flowOfFilm(*device, {mesh, kViscosity, 50}) / nusselt;
      std::printf("film on %s, %s, %g Pa·s: %.4f of the closed form\n", name.c_str(), mesh ? "mesh" : "plane",
                  kViscosity, ratio);
      // At a depth of six spacings.
      EXPECT_NEAR(ratio, 1, 0.1);
      const double narrow = flowOfFilm(*device, {mesh, kViscosity, 50, 0, 1.5}) / nusselt;
      std::printf("with a support of 1.5 spacings: %.4f\n", narrow);
      EXPECT_NEAR(narrow, 1, 0.1);
      EXPECT_NEAR(flowOfFilm(*device, {mesh, kViscosity, 50, 1.0}), kPull * 0.05, 0.03 * kPull * 0.05)
          << name;
    }
  }
}

TEST(ViscousWalls, WhatAPlaneDoesIsTheIntegralOverWhatIsBehindIt) {
  // By shells in double precision, c(r) = 10·|W'|/r with H = 1.
  for (const double q : {0.1, 0.3, 0.6, 0.9}) {
    constexpr int kParts = 2000;
    double sum = 0;
    for (int k = 0; k < kParts; ++k) {
      const double r = q + (1 - q) * (k + 0.5) / kParts, c = 10 * 45 / kPi * (1 - r) * (1 - r) / r;
      for (int m = 0; m < 50; ++m) {
        const double z = q + (r - q) * (m + 0.5) / 50;
        sum += c * (r * r - z * z) / (2 * r * r) * z / q * 2 * kPi * r * (r - q) / 50 * (1 - q) / kParts;
      }
    }
    EXPECT_NEAR(planeDrag(q), sum, 1e-3 * sum);
    EXPECT_NEAR(planeDrag(float(q)), sum, 2e-3 * sum + 1e-4);
  }
  EXPECT_NEAR(shearBehind(0.0), 0.5, 1e-12);
  // The same for what a mirror would add: all directions μ = cos θ beyond the plane, weight r³·(1 − r)²·(1 −
  // μ²)².
  for (const double q : {0.1, 0.3, 0.6, 0.9}) {
    constexpr int kParts = 400;
    double sum = 0;
    for (int k = 0; k < kParts; ++k) {
      const double r = q + (1 - q) * (k + 0.5) / kParts, weight = r * r * r * (1 - r) * (1 - r);
      for (int m = 0; m < kParts; ++m) {
        const double mu = q / r + (1 - q / r) * (m + 0.5) / kParts;
        sum += weight * (1 - mu * mu) * (1 - mu * mu) * (1 - q / r) / kParts * (1 - q) / kParts;
      }
    }
    constexpr double kWhole = 16.0 / 15 / 60;
    EXPECT_NEAR(shearBehind(q), sum / kWhole, 1e-3 * sum / kWhole + 1e-7);
    EXPECT_NEAR(shearBehind(float(q)), sum / kWhole, 1e-4);
  }
  // A plane at 0.3 H hides ½·(1 − q)⁵·(1 + 2q) of the kernel.
  EXPECT_NEAR(planeOf(0.5f * 0.16807f * 1.6f), 0.3f, 1e-5f);
}

TEST(ViscositySolver, WarnsOfASmallSupport) {
  CpuDevice device(1);
  for (const double ratio : {1.2, 1.5}) {
    FluidScene scene(device, jitteredCube(3, kSpacing, 0, 1), {},
                     object({{"spacing", kSpacing}, {"support_ratio", ratio}}), viscous(Value::object()));
    scene.reset(1e-3);
    const std::vector<std::string>& warnings = scene.warnings();
    EXPECT_EQ(
        std::any_of(warnings.begin(), warnings.end(),
                    [](const std::string& text) { return contains(text, "support_ratio of at least"); }),
        ratio < 1.5);
  }
}

TEST(ViscositySolver, RefusesWhatIsNoViscosityOrTolerance) {
  const auto refusal = [](Value params) {
    return std::string(errorOf([&] {
                         ViscositySolver module;
                         module.assignAll(params, {"test", "", ""});
                       }).what());
  };
  EXPECT_CONTAINS(refusal(object({{"viscosity", -1.0}})), "at least 0");
  EXPECT_CONTAINS(refusal(object({{"viscosity", 1e30}})), "at most");
  EXPECT_CONTAINS(refusal(object({{"tolerance", 0.0}})), "above 0");
  EXPECT_CONTAINS(refusal(object({{"max_iterations", 0}})), "at least 1");
}

}  // namespace
}  // namespace weir::test
