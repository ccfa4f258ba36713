// Surface tension in N/m against Laplace's pressure, Young's angle of contact, conservation of momentum, and
// the shape of a drop.
#include "nodes/particle_fluid/modules/capillary_force.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr double kSpacing = 0.01;

Value withTension(double tension, double angle = 90) {
  return object({{"tension", inserted("CapillaryForce", "viscosity",
                                      object({{"tension", tension}, {"contact_angle", angle}}))}});
}

/// Modules that leave positions alone, so that the forces of one step show in the velocities.
Value tensionOnly(double tension) {
  Value modules = withTension(tension);
  modules["solver"] = disabled();
  modules["viscosity"] = disabled();
  return modules;
}

Value fluidOf(double supportRatio) {
  return object({{"spacing", kSpacing}, {"support_ratio", supportRatio}, {"bulk_modulus", 1e5}});
}

template <class In>
std::vector<Vec3f> jitteredBlock(int n, float jitter, const In& in) {
  std::vector<Vec3f> positions;
  for (const Vec3f& p : jitteredCube(n, float(kSpacing), jitter, 3))
    if (in(p - Vec3f{1, 1, 1} * (0.5f * float(kSpacing) * float(n - 1)))) positions.push_back(p);
  return positions;
}

std::vector<Vec3f> ball(double radius) {
  return jitteredBlock(static_cast<int>(2 * radius) + 3, 0.2f,
                       [&](const Vec3f& p) { return double(length(p)) < radius * kSpacing; });
}

/// The velocities of particles at rest after one step of 1 ms.
std::vector<Vec3f> pushed(Device& device, const std::vector<Vec3f>& positions, double tension) {
  FluidScene scene(device, positions, {}, fluidOf(2), tensionOnly(tension));
  scene.gravity = {};
  scene.reset(1e-3);
  scene.step();
  return scene.velocities();
}

/// The mean over the last ten of some frames.
double meanOf(SimulatedScene& scene, int frames, const std::function<double(Simulation&)>& number) {
  const std::atomic<bool> stop = false;
  scene->reset();
  double sum = 0;
  for (int k = 0; k < frames; ++k) {
    EXPECT_TRUE(scene->advanceFrame(stop));
    if (k >= frames - 10) sum += number(*scene);
  }
  return sum / 10;
}

NodeReport reportOf(Simulation& simulation, const char* node) {
  NodeReport report;
  simulation.scene().graph.find(node)->report(report);
  return report;
}

constexpr const char* kBall = R"({"weir": 1,
  "world": {"gravity": [0, 0, 0], "dt": 0.001, "frame_rate": 50, "duration": 1},
  "nodes": {
    "ball": {"type": "SphereSampler", "params": {"center": [0, 0, 0], "radius": 0.05, "arrangement": "relaxed"}},
    "fluid": {"type": "ParticleFluid",
              "params": {"spacing": 0.01, "support_ratio": 2, "bulk_modulus": 1e5, "rest_steps": 300,
                         "pressure": true},
              "modules": {"viscosity": {"params": {"form": "explicit", "strength": 0.05}},
                          "tension": {"type": "CapillaryForce", "after": "viscosity", "params": {"tension": 0.5}}}},
    "inside": {"type": "Gauge",
               "params": {"shape": "box", "min": [-0.02, -0.02, -0.02], "max": [0.02, 0.02, 0.02]}}},
  "links": ["ball.particles -> fluid.initial", "fluid.fluid -> inside.particles"]})";

TEST(CapillaryForce, ADropHasLaplacesPressureAndStaysWhereItIs) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SimulatedScene scene(*device, kBall);
    const double found = meanOf(scene, 20, [](Simulation& simulation) {
      return reportOf(simulation, "inside").statistics["pressure"].asDouble();
    });
    NodeReport report = reportOf(*scene, "fluid");
    const double volume = report.statistics["fluid_volume"].asDouble();
    Vec3d momentum;
    for (int k = 0; k < 3; ++k)
      momentum[k] = report.statistics["linear_momentum"].asArray()[std::size_t(k)].asDouble();
    const double drift = length(momentum) / (1000 * volume);
    const double expected = 2 * 0.5 / std::cbrt(3 * volume / (4 * std::numbers::pi));
    std::printf("pressure in a drop of 5 d over Laplace's on %s: %.4f; it drifts with %.2g m/s\n",
                name.c_str(), found / expected, drift);
    EXPECT_NEAR(found / expected, 1, 0.03) << name;
    EXPECT_LT(drift, 1e-4) << name;
  }
}

constexpr const char* kTable = R"({"weir": 1, "let": {"angle": 90},
  "world": {"gravity": [0, 0, 0], "dt": 0.002, "frame_rate": 20, "duration": 2},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [-0.07, 0, -0.07], "max": [0.07, 0.07, 0.07]}},
    TABLE,
    "fluid": {"type": "ParticleFluid", "params": {"spacing": 0.01, "support_ratio": 2, "bulk_modulus": 1e5, "rest_steps": 300},
              "modules": {"viscosity": {"params": {"form": "explicit", "strength": 1}},
                          "tension": {"type": "CapillaryForce", "after": "viscosity",
                                      "params": {"tension": 4, "contact_angle": "=angle"}}}}},
  "links": ["block.particles -> fluid.initial", LINK]})";
const std::string kPlane = R"("table": {"type": "StaticBoundary", "params": {"shape": "plane"}})";
const std::string kPlaneLink = R"("table.boundary -> fluid.boundaries")";
const std::string kSlab = R"(
  "slab": {"type": "BoxMesh", "params": {"min": [-0.3, -0.1, -0.3], "max": [0.3, 0, 0.3]}},
  "table": {"type": "SemiAnalyticalSFI"})";
const std::string kSlabLink = R"("slab.surface -> table.solids", "fluid.fluid -> table.fluid")";

std::string onTable(const std::string& table, const std::string& link) {
  std::string text = kTable;
  text.replace(text.find("TABLE"), 5, table);
  return text.replace(text.find("LINK"), 4, link);
}

/// The angle of contact, in degrees, of a cap of a ball by the height of its centre of mass over the cube
/// root of its volume.
double capAngle(double height) {
  double low = 0.01, high = std::numbers::pi - 0.01;
  for (int k = 0; k < 60; ++k) {
    const double angle = (low + high) / 2, c = std::cos(angle);
    const double radius = std::cbrt(3 / (std::numbers::pi * (2 + c) * (1 - c) * (1 - c)));
    (radius * (3 * (1 + c) * (1 + c) / (4 * (2 + c)) - c) < height ? low : high) = angle;
  }
  return low * 180 / std::numbers::pi;
}

double settledAngle(Device& device, double angle, const std::string& table, const std::string& link) {
  SimulatedScene scene(device, onTable(table, link), {"let.angle=" + std::to_string(angle)});
  return meanOf(scene, 40, [](Simulation& simulation) {
    NodeReport report = reportOf(simulation, "fluid");
    return capAngle(report.statistics["center_of_mass"].asArray()[1].asDouble() /
                    std::cbrt(report.statistics["fluid_volume"].asDouble()));
  });
}

TEST(CapillaryForce, DropsOnATableHaveTheirAngleOfContact) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const double onPlane = settledAngle(*device, 60, kPlane, kPlaneLink);
    const double onMesh = settledAngle(*device, 120, kSlab, kSlabLink);
    std::printf("drops on %s: %.1f degrees on a plane, to be 60; %.1f on a mesh, to be 120\n", name.c_str(),
                onPlane, onMesh);
    EXPECT_NEAR(onPlane, 60, 5) << name;
    EXPECT_NEAR(onMesh, 120, 5) << name;
  }
}

/// ⟨x⁴ + y⁴ + z⁴⟩/⟨r⁴⟩ about the centre: 0.6 for a ball, 0.474 for a cube.
double cubicMoment(const std::vector<Vec3f>& positions) {
  const Vec3d center = sumOf(positions) / double(positions.size());
  double axes = 0, all = 0;
  for (const Vec3f& p : positions) {
    const Vec3d d = toDouble(p) - center, squares{d.x * d.x, d.y * d.y, d.z * d.z};
    axes += dot(squares, squares);
    all += dot(d, d) * dot(d, d);
  }
  return axes / all;
}

TEST(CapillaryForce, ACubeBecomesABall) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> cube = jitteredCube(8, float(kSpacing), 0, 1);
    FluidScene scene(*device, cube, {}, fluidOf(2), withTension(2));
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step(600);
    const double before = cubicMoment(cube), after = cubicMoment(scene.positions());
    std::printf("cubic moment on %s: %.4f, then %.4f\n", name.c_str(), before, after);
    EXPECT_LT(before, 0.48) << name;
    EXPECT_NEAR(after, 0.6, 0.015) << name;
  }
}

TEST(CapillaryForce, WithoutTensionNothingChanges) {
  CpuDevice device(1);
  for (const Vec3f& v : pushed(device, ball(4), 0)) EXPECT_EQ(length(v), 0);
}

TEST(CapillaryForce, LeavesAFlatSurfaceAlone) {
  CpuDevice device(1);
  const double tension = 0.5;
  // The upper side of a slab, far from its rims.
  const std::vector<Vec3f> positions =
      jitteredBlock(24, 0, [](const Vec3f& p) { return std::abs(double(p.y)) < 4 * kSpacing; });
  const std::vector<Vec3f> v = pushed(device, positions, tension);
  Vec3d middle{};
  const Vec3d center = sumOf(positions) / double(positions.size());
  double area = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec3d r = toDouble(positions[i]) - center;
    if (r.y < 0 || std::abs(r.x) > 6 * kSpacing || std::abs(r.z) > 6 * kSpacing) continue;
    middle += toDouble(v[i]);
    area += r.y > 3 * kSpacing ? kSpacing * kSpacing : 0;
  }
  const double mass = 1000 * std::pow(kSpacing, 3), pressure = mass * length(middle) / (1e-3 * area);
  std::printf("pressure of a flat surface: %.2g of that of a ball of 8 d\n",
              pressure / (2 * tension / (8 * kSpacing)));
  EXPECT_LT(pressure, 0.05 * 2 * tension / (8 * kSpacing));
}

TEST(CapillaryForce, SingleParticlesThreadsAndSheetsDoNotFlyApart) {
  CpuDevice device(1);
  const auto speed = [&](const std::vector<Vec3f>& positions) {
    FluidScene scene(device, positions, {}, fluidOf(2), withTension(1));
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step(200);
    double max = 0;
    for (const Vec3f& v : scene.velocities()) max = std::max(max, double(length(v)));
    return max;
  };
  const double capillary = std::sqrt(1 / (1000 * kSpacing));  // √(σ/ρd)
  EXPECT_EQ(speed({{0, 0, 0}}), 0);
  const double thread = speed(jitteredBlock(16, 0.2f, [](const Vec3f& p) {
    return std::abs(double(p.x)) < kSpacing && std::abs(double(p.z)) < kSpacing;
  }));
  const double sheet =
      speed(jitteredBlock(16, 0.2f, [](const Vec3f& p) { return std::abs(double(p.y)) < 0.7 * kSpacing; }));
  std::printf("fastest particle over √(σ/ρd): thread %.2g, sheet %.2g\n", thread / capillary,
              sheet / capillary);
  EXPECT_LT(thread, 3 * capillary);
  EXPECT_LT(sheet, 3 * capillary);
}

TEST(CapillaryForce, RefusesWhatIsNoTension) {
  const auto refusal = [](const char* parameter, double value) {
    return std::string(errorOf([&] {
                         CapillaryForce module;
                         module.assignAll(object({{parameter, value}}), {"test", "", ""});
                       }).what());
  };
  EXPECT_CONTAINS(refusal("tension", -1), "at least 0");
  EXPECT_CONTAINS(refusal("tension", 1e30), "at most");
  EXPECT_CONTAINS(refusal("contact_angle", 181), "at most 180");
  EXPECT_CONTAINS(refusal("air_pressure", -1), "at least 0");
}

TEST(CapillaryForce, WarnsOfASmallSupportAndOfTooLongAStep) {
  CpuDevice device(1);
  const auto warningsOf = [&](double supportRatio, double tension) {
    FluidScene scene(device, ball(3), {}, fluidOf(supportRatio), withTension(tension));
    scene.gravity = {};
    scene.reset(1e-3);
    std::string all;
    for (const std::string& warning : scene.warnings())
      if (contains(warning, "'tension'")) all += warning + "\n";
    return all;
  };
  EXPECT_EQ(warningsOf(2, 99), "");
  EXPECT_CONTAINS(warningsOf(1.5, 1), "support_ratio of at least 2");
  EXPECT_CONTAINS(warningsOf(2, 400), "tension·dt²/(rest_density·spacing³) = 0.4");
  EXPECT_CONTAINS(warningsOf(2, 400), "at most 1.6e+02 N/m, or a world.dt of at most 0.00063 s");
}

}  // namespace
}  // namespace weir::test
