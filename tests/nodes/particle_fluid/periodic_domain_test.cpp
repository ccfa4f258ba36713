// Fluids in a periodic domain: conservation, translation, closed forms of flows without ends, fillings that
// go on through the faces, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "framework/compute/cpu_threads.h"
#include "framework/particles/relaxed_tile.h"
#include "nodes/gauge/gauge.h"
#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/expect_error.h"
#include "tests/support/resumed_scene.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kSpacing = 0.01f;

/// Fluid at rest that fills a box of so many spacings, multiples of 12, without a seam.
std::vector<Vec3f> filling(const Vec3i& cells, float spacing = kSpacing) {
  CpuThreads threads(2);
  const RelaxedTile tile(2, 12, 300, 1, threads);
  std::vector<Vec3f> positions;
  for (int x = 0; x < cells.x; ++x)
    for (int y = 0; y < cells.y; ++y)
      for (int z = 0; z < cells.z; ++z) {
        const Vec3f u = tile.displacement(x, y, z);
        positions.push_back(spacing * Vec3f{x + 0.5f + u.x, y + 0.5f + u.y, z + 0.5f + u.z});
      }
  return positions;
}

Value vec(const Vec3f& v) {
  return Value::Array{double(v.x), double(v.y), double(v.z)};
}

/// Of a fluid in the box from 0 to `size`.
Value inBox(const Vec3f& size, const char* axes = "xyz") {
  return object({{"spacing", kSpacing},
                 {"support_ratio", 2.0},
                 {"domain_min", vec({})},
                 {"domain_max", vec(size)},
                 {"periodic", axes}});
}

std::vector<Vec3f> wrappedInto(const Period& period, std::vector<Vec3f> positions) {
  for (Vec3f& p : positions) p = period.wrapped(p);
  return positions;
}

/// Each of the solvers and viscosities that know of periodic domains, with that many iterations.
std::vector<std::pair<const char*, Value>> pipelines(int iterations) {
  const auto with = [&](const char* step, const char* name, Value module) {
    const Value params = object({{"iterations", iterations}, {"step_length", step}});
    Value modules = object({{"solver", object({{"params", params}})}});
    if (name != nullptr) modules[name] = std::move(module);
    return modules;
  };
  const auto accelerated = [&](const char* by) {
    const Value params = object({{"acceleration", by}, {"max_iterations", iterations}});
    return object({{"solver", object({{"type", "AcceleratedSolver"}, {"params", params}})}});
  };
  return {
      {"default", with("full", nullptr, {})},
      {"ViscositySolver",
       with("full", "viscous", inserted("ViscositySolver", "walls", object({{"viscosity", 5.0}})))},
      {"SurfaceTension",
       with("full", "tension", inserted("SurfaceTension", "viscosity", object({{"air_pressure", 5.0}})))},
      {"CapillaryForce",
       with("full", "tension", inserted("CapillaryForce", "viscosity", object({{"air_pressure", 5.0}})))},
      {"VorticityConfinement",
       with("full", "eddies", inserted("VorticityConfinement", "viscosity", object({{"strength", 0.0}})))},
      {"implicit XSPH", with("full", "viscosity", object({{"params", object({{"form", "implicit"}})}}))},
      {"global step", with("global", nullptr, {})},
      {"Pbf",
       object({{"solver", object({{"type", "Pbf"}, {"params", object({{"iterations", iterations}})}})}})},
      {"TwoProjections", object({{"solver", object({{"type", "TwoProjections"}})}})},
      {"Nesterov", accelerated("nesterov")},
      {"conjugate gradients", accelerated("conjugate")}};
}

TEST(PeriodicDomain, KeepsMomentum) {
  const Vec3f size{0.12f, 0.12f, 0.12f};
  const std::vector<Vec3f> positions = wrappedInto({{}, size}, filling({12, 12, 12}));
  const std::vector<Vec3f> velocities = randomVelocities(positions.size(), 0.5f, 4);
  const Vec3d first = sumOf(velocities);
  // The substitution keeps it as far as it has converged.
  for (const auto& [what, modules] : pipelines(200)) {
    if (contains(what, "implicit")) continue;  // it goes to the mean over neighbours, which keeps no momentum
    CpuDevice device(2);
    FluidScene scene(device, positions, velocities, inBox(size), modules);
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step(5);
    const std::vector<Vec3f> after = scene.velocities();
    ASSERT_EQ(after.size(), positions.size()) << what;
    double moved = 0;
    for (std::size_t i = 0; i < after.size(); ++i)
      moved = std::max(moved, length(toDouble(after[i]) - toDouble(velocities[i])));
    const double drift = length(sumOf(after) - first) / double(after.size());
    std::printf("%s: %.2g m/s of momentum gained, of %.2g m/s that particles gain\n", what, drift, moved);
    EXPECT_GT(moved, 0.1) << what;
    EXPECT_LT(drift, 5e-6) << what;
  }
}

/// m/s in five steps. Conjugate gradients magnify what rounding makes different.
constexpr double kRounding = 5e-4;

TEST(PeriodicDomain, TwoPeriodsMoveAsOne) {
  // The same fluid once more beside itself, in a box twice as long: each copy must move as the single one.
  const Vec3f size{0.12f, 0.12f, 0.12f};
  const std::vector<Vec3f> once = wrappedInto({{}, size}, filling({12, 12, 12}));
  const std::vector<Vec3f> velocities = randomVelocities(once.size(), 0.3f, 4);
  std::vector<Vec3f> twice = once, both = velocities;
  for (std::size_t i = 0; i < once.size(); ++i)
    twice.push_back(once[i] + Vec3f{size.x, 0, 0}), both.push_back(velocities[i]);
  for (const auto& [what, modules] : pipelines(3)) {
    CpuDevice device(2);
    FluidScene one(device, once, velocities, inBox(size), modules);
    FluidScene two(device, twice, both, inBox({2 * size.x, size.y, size.z}), modules);
    for (FluidScene* scene : {&one, &two}) scene->gravity = {0.3f, 0, 0}, scene->reset(1e-3), scene->step(5);
    const std::vector<Vec3f> expected = one.velocities(), found = two.velocities();
    double largest = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
      largest = std::max(largest, length(toDouble(found[i]) - toDouble(expected[i % expected.size()])));
    std::printf("%s: largest difference %.2g m/s\n", what, largest);
    EXPECT_LT(largest, kRounding) << what;
  }
}

TEST(PeriodicDomain, PlacesOfTheFacesChangeNothing) {
  const Vec3f size{0.12f, 0.12f, 0.12f}, by{0.06f, 0.06f, 0.06f};
  const Period period{{}, size};
  const std::vector<Vec3f> positions = wrappedInto(period, filling({12, 12, 12}));
  std::vector<Vec3f> shifted = positions;
  for (Vec3f& p : shifted) p += by;
  const std::vector<Vec3f> velocities = randomVelocities(positions.size(), 0.3f, 4);
  for (const auto& [what, modules] : pipelines(3)) {
    CpuDevice device(2);
    FluidScene one(device, positions, velocities, inBox(size), modules);
    FluidScene other(device, wrappedInto(period, shifted), velocities, inBox(size), modules);
    for (FluidScene* scene : {&one, &other})
      scene->gravity = {0.3f, 0, 0}, scene->reset(1e-3), scene->step(5);
    const std::vector<Vec3f> expected = one.velocities(), found = other.velocities();
    double largest = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
      largest = std::max(largest, length(toDouble(found[i]) - toDouble(expected[i])));
    std::printf("%s: largest difference %.2g m/s\n", what, largest);
    EXPECT_LT(largest, kRounding) << what;
  }
}

// ---- Flows with closed forms ----------------------------------------------------------------------------

/// A channel between plates at y = 0 and 0.12 m, a slab of 12 by 4 spacings, periodic along x and z, with a
/// viscosity of 10 Pa·s. Its speed of sound is 30 times the speed of the flow: stiffer fluid has an inner
/// friction of its own, in proportion to its pressure.
constexpr const char* kChannel = R"({"weir": 1,
  "let": {"spacing": 0.01},
  "world": {"gravity": [PULL, 0, 0], "dt": 0.002, "frame_rate": 10, "duration": 2},
  "nodes": {
    "fill": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": ["=12*spacing", 0.12, "=4*spacing"]}},
    NODES,
    "honey": {"type": "ParticleFluid",
              "params": {"spacing": "=spacing", "bulk_modulus": 1e4, "rest_steps": 200, "periodic": "xz",
                         "domain_min": [0, -1, 0], "domain_max": ["=12*spacing", 1, "=4*spacing"]},
              "modules": {"solver": {"params": {"iterations": 20}}, "viscosity": {"enabled": false},
                          "viscous": {"type": "ViscositySolver", "after": "walls", "params": {"viscosity": 10}}}}},
  "links": ["fill.particles -> honey.initial", LINKS]})";

std::string channel(double pull, const std::string& nodes, const std::string& links) {
  std::string text = kChannel;
  for (const auto& [name, value] : {std::pair<std::string, std::string>{"PULL", std::to_string(pull)},
                                    {"NODES", nodes},
                                    {"LINKS", links}})
    for (auto at = text.find(name); at != std::string::npos; at = text.find(name))
      text.replace(at, name.size(), value);
  return text;
}

const std::string kPlanes = R"(
  "low": {"type": "StaticBoundary", "params": {"shape": "plane"}},
  "high": {"type": "StaticBoundary", "params": {"shape": "plane", "normal": [0, -1, 0], "position": [0, 0.12, 0]}})";
const std::string kPlaneLinks = R"("low.boundary -> honey.boundaries", "high.boundary -> honey.boundaries")";
const std::string kPlates = R"(
  "block": {"type": "BoxMesh", "params": {"min": [-1, -0.1, -1], "max": [2, 0, 1]}},
  "lid": {"type": "BoxMesh", "params": {"min": [-2, 0.12, -1], "max": [2, 0.22, 1]}},
  "low": {"type": "SemiAnalyticalSFI"}, "high": {"type": "SemiAnalyticalSFI", "params": {"velocity": [0, 0, 0]}})";
const std::string kPlateLinks = R"("block.surface -> low.solids", "lid.surface -> high.solids",
  "honey.fluid -> low.fluid", "honey.fluid -> high.fluid")";

void advance(Simulation& simulation, int frames) {
  const std::atomic<bool> stop = false;
  for (int k = 0; k < frames; ++k) ASSERT_TRUE(simulation.advanceFrame(stop));
}

/// Mean velocity along x, m/s.
double meanFlow(ParticleSet& particles) {
  return sumOf(particles.velocities().toHost(particles.refreshCount())).x / double(particles.bound());
}

std::string spacingOf(int layers) {
  return "let.spacing=" + std::to_string(0.12 / layers);
}

/// What the particles between the plates do as they become finer, from 6 and 12 layers. Where the wall stands
/// is known to a share of a spacing, so the error is of the first order.
struct Refined {
  double coarse, fine;
  double limit() const { return 2 * fine - coarse; }
};

TEST(PeriodicDomain, PoiseuilleFlow) {
  constexpr double kPull = 0.5, kHeight = 0.12, kNu = 0.01, kMean = kPull * kHeight * kHeight / (12 * kNu);
  const auto flow = [&](int layers) {
    CpuDevice device(2);
    SimulatedScene scene(device, channel(kPull, kPlanes, kPlaneLinks), {spacingOf(layers)});
    scene->reset();
    advance(*scene, 8);
    ParticleSet& particles = scene.node<ParticleFluid>("honey").fluid->set();
    const double ratio = meanFlow(particles) / kMean;
    // Nothing goes across the slab.
    double across = 0;
    for (const Vec3f& v : particles.velocities().toHost(particles.bound())) across += double(v.z) * v.z;
    EXPECT_LT(std::sqrt(across / double(particles.bound())), 0.05 * kMean);
    return ratio;
  };
  const Refined ratio{flow(6), flow(12)};
  std::printf("Poiseuille: %.4f and %.4f of the closed form, limit %.4f\n", ratio.coarse, ratio.fine,
              ratio.limit());
  EXPECT_NEAR(ratio.fine, 1, 0.12);
  EXPECT_NEAR(ratio.limit(), 1, 0.03);
}

TEST(PeriodicDomain, CouetteFlow) {
  constexpr double kSpeed = 0.1, kHeight = 0.12, kViscosity = 10;
  const auto drag = [&](int layers) {
    CpuDevice device(2);
    SimulatedScene scene(device, channel(0, kPlates, kPlateLinks),
                         {spacingOf(layers), "high.velocity=[0.1, 0, 0]"});
    scene->reset();
    double sum = 0;
    advance(*scene, 4);
    for (int k = 0; k < 4; ++k) {
      advance(*scene, 1);
      sum -= scene.node<SemiAnalyticalSFI>("high").forces->solids.at(0).force.x;
    }
    EXPECT_NEAR(meanFlow(scene.node<ParticleFluid>("honey").fluid->set()), kSpeed / 2, 0.02 * kSpeed);
    const double spacing = kHeight / layers, area = 12 * spacing * 4 * spacing;
    return sum / 4 / (kViscosity * kSpeed / kHeight * area);
  };
  const Refined ratio{drag(6), drag(12)};
  std::printf("drag on a plate: %.4f and %.4f of the closed form, limit %.4f\n", ratio.coarse, ratio.fine,
              ratio.limit());
  EXPECT_NEAR(ratio.fine, 1, 0.12);
  EXPECT_NEAR(ratio.limit(), 1, 0.05);
}

/// The rate at which a Taylor–Green vortex decays, over 2·ν·k².
double decayOfTaylorGreen(int cells, double viscosity, double speed, double dt, int steps) {
  const double length = cells * double(kSpacing), k = 2 * kPi / length, nu = viscosity / 1000;
  const Vec3f size{float(length), float(length), 12 * kSpacing};
  const std::vector<Vec3f> positions = wrappedInto({{}, size}, filling({cells, cells, 12}));
  const auto mode = [&](const Vec3f& p) {
    return Vec3d{std::sin(k * p.x) * std::cos(k * p.y), -std::cos(k * p.x) * std::sin(k * p.y), 0};
  };
  std::vector<Vec3f> velocities;
  for (const Vec3f& p : positions) {
    const Vec3d v = speed * mode(p);
    velocities.push_back({float(v.x), float(v.y), 0});
  }
  CpuDevice device(2);
  FluidScene scene(
      device, positions, velocities, inBox(size),
      object({{"viscosity", disabled()},
              {"viscous", inserted("ViscositySolver", "walls", object({{"viscosity", viscosity}}))}}));
  scene.gravity = {};
  scene.reset(dt);
  const auto amplitude = [&] {
    const std::vector<Vec3f> x = scene.positions(), v = scene.velocities();
    double sum = 0, norm = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      sum += dot(toDouble(v[i]), mode(x[i])), norm += dot(mode(x[i]), mode(x[i]));
    return sum / norm;
  };
  const double before = amplitude();
  scene.step(steps);
  // Implicit steps multiply by 1/(1 + 2·ν·k²·dt), each.
  const double growth = std::pow(before / amplitude(), 1.0 / steps) - 1;
  return growth / (2 * nu * k * k * dt);
}

TEST(PeriodicDomain, TaylorGreenVorticesDecay) {
  const double rate = decayOfTaylorGreen(24, 10, 0.1, 1e-3, 60);
  std::printf("Taylor-Green: decays at %.4f of the rate of the closed form\n", rate);
  EXPECT_NEAR(rate, 1, 0.05);
}

// ---- Runs ----------------------------------------------------------------------------------------------

TEST(PeriodicDomain, ResumesExactly) {
  for (const bool mesh : {false, true}) {
    const std::string text = channel(0.5, mesh ? kPlates : kPlanes, mesh ? kPlateLinks : kPlaneLinks);
    EXPECT_EQ(resumedSceneDifferences(text, {}, {"world.frame_rate=100", "honey.rest_steps=50"}),
              std::vector<std::string>{});
  }
}

std::string refusalOf(const std::string& text, const std::vector<std::string>& changes = {}) {
  CpuDevice device(1);
  return errorOf([&] {
           SimulatedScene scene(device, text, changes);
           scene->reset();
         })
      .what();
}

TEST(PeriodicDomain, RefusesWhatDoesNotKnowOfIt) {
  const std::string planes = channel(0, kPlanes, kPlaneLinks);
  EXPECT_CONTAINS(refusalOf(planes, {"low.normal=[0.1, 1, 0]"}), "plane across x");
  const auto with = [&](const std::string& node, const std::string& link) {
    return channel(0, kPlanes + ", \"more\": " + node, kPlaneLinks + ", \"" + link + "\"");
  };
  EXPECT_CONTAINS(refusalOf(with(R"({"type": "FluidSurface"})", "honey.fluid -> more.fluid")),
                  "periodic domain");
  EXPECT_CONTAINS(refusalOf(with(R"({"type": "WhiteWater"})", "honey.fluid -> more.fluid")),
                  "periodic domain");
  EXPECT_CONTAINS(refusalOf(with(R"({"type": "Gauge", "params": {"shape": "plane", "normal": [1, 0, 0]}})",
                                 "honey.fluid -> more.particles")),
                  "at least 0.02 m");
  // It ends within a support radius of the faces.
  EXPECT_CONTAINS(refusalOf(with(R"({"type": "StaticBoundary", "params": {"shape": "sphere", "radius": 0.02,
                                      "position": [0.01, 0.06, 0.02]}})",
                                 "more.boundary -> honey.boundaries")),
                  "both faces");
  EXPECT_CONTAINS(
      refusalOf(with(R"({"type": "BoxSampler", "params": {"min": [0.1, 0, 0], "max": [0.2, 0.1, 0.04]}})",
                     "more.particles -> honey.initial")),
      "outside of the periodic domain");
}

TEST(PeriodicDomain, GaugesSeeThroughTheFaces) {
  CpuDevice device(2);
  const std::string text =
      channel(0, kPlanes + R"(, "seam": {"type": "Gauge", "params": {"position": [0, 0.06, 0]}},
                                      "inside": {"type": "Gauge", "params": {"position": [0.06, 0.06, 0.02]}})",
              kPlaneLinks + R"(, "honey.fluid -> seam.particles", "honey.fluid -> inside.particles")");
  SimulatedScene scene(device, text, {"fill.arrangement=\"lattice\""});
  scene->reset();
  const auto filled = [&](const char* name) {
    NodeReport report;
    scene.node<Gauge>(name).report(report);
    return report.statistics["filled"].asDouble();
  };
  EXPECT_NEAR(filled("inside"), 1, 0.05);
  EXPECT_NEAR(filled("seam"), filled("inside"), 1e-4);
}

// ---- Fillings --------------------------------------------------------------------------------------------

TEST(PeriodicDomain, SamplersFillItEvenly) {
  for (const char* arrangement : {"relaxed", "lattice"}) {
    CpuDevice device(2);
    SimulatedScene scene(device, channel(0, kPlanes, kPlaneLinks),
                         {std::string("fill.arrangement=") + arrangement, "fill.max=[0.12, 0.06, 0.04]",
                          "world.gravity=[0, -9.8, 0]"});
    scene->reset();
    ParticleSet& particles = scene.node<ParticleFluid>("honey").fluid->set();
    const std::int64_t n = particles.refreshCount();
    EXPECT_EQ(n, 12 * 6 * 4);
    const Period period{{0, 0, 0}, {0.12f, 0, 0.04f}};
    const std::vector<Vec3f> x = particles.positions().toHost(n);
    const std::vector<float> density = particles.get<float>("density").toHost(n);
    double atSeam = 0, inside = 0, nearest = 1;
    int seam = 0, middle = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_EQ(period.wrapped(x[i]), x[i]);
      if (x[i].y < 0.02f || x[i].y > 0.04f) continue;
      const bool beside = x[i].x < kSpacing || x[i].x > 0.12f - kSpacing;
      (beside ? atSeam : inside) += double(density[i]);
      ++(beside ? seam : middle);
      for (std::size_t j = 0; j < i; ++j) {
        double square = 0;
        for (int axis = 0; axis < 3; ++axis) {
          double d = double(x[i][axis]) - double(x[j][axis]);
          if (period.along(axis)) d -= double(period.size[axis]) * std::round(d / double(period.size[axis]));
          square += d * d;
        }
        nearest = std::min(nearest, std::sqrt(square) / double(kSpacing));
      }
    }
    std::printf("%s: density %.1f at the seam, %.1f elsewhere; nearest pair %.3f spacings\n", arrangement,
                atSeam / seam, inside / middle, nearest);
    EXPECT_NEAR(atSeam / seam, inside / middle, 5);
    EXPECT_GT(nearest, 0.6);
  }
}

}  // namespace
}  // namespace weir::test
