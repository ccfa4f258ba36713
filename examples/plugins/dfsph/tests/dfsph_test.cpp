// The criteria of the paper, measured here from positions and velocities in double precision: a column of
// fluid that comes down and spreads keeps its density within 0.1 %, and its divergence near 0; its momentum
// changes by gravity and walls alone, and a tank feels the fluid's weight.
//
// Takes the plugin's file as its argument; ends with 0 if all is well.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include <weir/particle_fluid.h>
#include <weir/plugin.h>
#include <weir/simulation.h>
#include <weir/solid_nodes.h>

namespace {

using namespace weir;

constexpr const char* kDam = R"({
  "weir": 1,
  "world": { "dt": 0.002, "frame_rate": 20, "duration": 0.4 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.3, 0.2] } },
    "walls": { "type": "BoxMesh", "params": { "min": [0, 0, 0], "max": [0.5, 0.6, 0.2] } },
    "tank": { "type": "SemiAnalyticalSFI", "params": { "fill": "container" } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.025, "support_ratio": 2 },
               "modules": { "solver": { "type": "Dfsph" } } }
  },
  "links": ["block.particles -> water.initial", "water.fluid -> tank.fluid", "walls.surface -> tank.solids"]
})";

// Water that stands in a tank, whose weight the tank must feel.
constexpr const char* kTank = R"({
  "weir": 1,
  "world": { "dt": 0.002, "frame_rate": 10, "duration": 0.3 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.2, 0.2] } },
    "walls": { "type": "BoxMesh", "params": { "min": [0, 0, 0], "max": [0.2, 0.4, 0.2] } },
    "tank": { "type": "SemiAnalyticalSFI", "params": { "fill": "container" } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.025, "support_ratio": 2, "rest_steps": 300 },
               "modules": { "solver": { "type": "Dfsph" } } }
  },
  "links": ["block.particles -> water.initial", "water.fluid -> tank.fluid", "walls.surface -> tank.solids"]
})";

// Two drops that meet in free space.
constexpr const char* kDrops = R"({
  "weir": 1,
  "world": { "gravity": [0, 0, 0], "dt": 0.002, "frame_rate": 20, "duration": 0.2 },
  "nodes": {
    "left": { "type": "SphereSampler", "params": { "center": [-0.12, 0, 0], "radius": 0.1, "velocity": [1, 0, 0] } },
    "right": { "type": "SphereSampler", "params": { "center": [0.12, 0.03, 0], "radius": 0.1, "velocity": [-1, 0, 0] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.025, "support_ratio": 2 },
               "modules": { "solver": { "type": "Dfsph" } } }
  },
  "links": ["left.particles -> water.initial", "right.particles -> water.initial"]
})";

int failures = 0;

void expect(bool holds, const char* what, double found) {
  if (holds) return;
  ++failures;
  std::printf("WRONG: %s is %.3g\n", what, found);
}

/// Means over all particles of max(ρ/ρ0 − 1, 0), and of max(dρ/dt/ρ0, 0) in 1/s among the fluid's own.
struct Measured {
  double compression = 0, growth = 0;
};

/// Slow and obvious. The density is the fluid's own attribute, as it includes the walls.
Measured measure(const ParticleFluid& water) {
  const FluidConstants& c = water.constants();
  const ParticleSet& particles = water.fluid->set();
  const std::int64_t n = particles.bound();
  const auto x = particles.positions().toHost(n), v = particles.velocities().toHost(n);
  const auto density = particles.get<float>("density").toHost(n);
  Measured result;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double growth = 0;
    bool whole = true;  // far enough from walls: all of the growth is the fluid's
    for (int k = 0; k < 3; ++k) whole &= x[i][k] > c.supportRadius;
    for (std::size_t j = 0; j < x.size(); ++j) {
      const Vec3d d{double(x[i].x) - x[j].x, double(x[i].y) - x[j].y, double(x[i].z) - x[j].z};
      const double r = std::sqrt(dot(d, d)), h = c.supportRadius;
      if (j == i || r >= h || r == 0) continue;
      const double slope = -c.calibration * 45 / (std::numbers::pi * std::pow(h, 4)) * std::pow(1 - r / h, 2);
      const Vec3d w{double(v[i].x) - v[j].x, double(v[i].y) - v[j].y, double(v[i].z) - v[j].z};
      growth += c.particleVolume * slope / r * dot(d, w);
    }
    result.compression += std::max(double(density[i]) / c.restDensity - 1, 0.0);
    if (whole && density[i] > 0.9 * c.restDensity) result.growth += std::max(growth, 0.0);
  }
  result.compression /= double(n);
  result.growth /= double(n);
  return result;
}

Vec3d momentumPerMass(const ParticleSet& particles) {
  Vec3d sum{};
  for (const Vec3f& v : particles.velocities().toHost(particles.bound())) sum += Vec3d{v.x, v.y, v.z};
  return sum / double(particles.bound());
}

template <class Check>
void run(const char* pluginFile, const char* text, const Check& check) {
  Registry registry;
  registerNodes(registry);
  const Plugin plugin(pluginFile, registry);
  std::vector<std::string> warnings;
  auto scene = buildScene(parseJson(text, "test"), {"test", "", "."}, registry, {}, warnings);
  const auto device = openDevice("auto");
  Log log(
      [](LogLevel, std::string_view message) { std::printf("%.*s\n", int(message.size()), message.data()); },
      LogLevel::kWarning);
  Simulation simulation(std::move(scene), *device, log, registry);
  simulation.reset();
  auto& water = dynamic_cast<ParticleFluid&>(*simulation.scene().graph.find("water"));
  const std::atomic<bool> never = false;
  while (simulation.advanceFrame(never)) check(simulation, water);
}

void runAll(const char* pluginFile) {
  double max = 0, maxGrowth = 0;
  run(pluginFile, kDam, [&](Simulation& simulation, ParticleFluid& water) {
    const Measured now = measure(water);
    NodeReport report;
    water.report(report);
    const auto of = [&](const char* solver, const char* what) {
      return report.statistics.find(solver)->find(what)->asDouble();
    };
    std::printf("t = %.2f s: density %.4f %% (solver %.4f %%, %.1f iterations), divergence %.2g 1/s, %.1f\n",
                simulation.time(), 100 * now.compression, 100 * of("density_solver", "error"),
                of("density_solver", "iterations"), now.growth, of("divergence_solver", "iterations"));
    max = std::max(max, now.compression);
    maxGrowth = std::max(maxGrowth, 0.002 * now.growth);
  });
  expect(max < 1e-3, "the dam's largest mean density error", max);
  // Viscosity acts after the solver, and the lists are those of the predicted positions.
  expect(maxGrowth < 1e-3, "the dam's largest mean growth of density in a step", maxGrowth);

  run(pluginFile, kTank, [&](Simulation& simulation, ParticleFluid& water) {
    const auto& tank = dynamic_cast<SemiAnalyticalSFI&>(*simulation.scene().graph.find("tank"));
    const double force = tank.forces->solids.front().force.y;
    const double weight = 9.8 * double(water.particleCount()) * water.constants().particleMass;
    std::printf("t = %.2f s: force on the tank %.2f N, weight %.2f N\n", simulation.time(), force, weight);
    expect(std::abs(force + weight) < 0.05 * weight, "the force on the tank over the weight", force / weight);
  });

  Vec3d drift{};
  run(pluginFile, kDrops, [&](Simulation&, ParticleFluid& water) {
    drift = momentumPerMass(water.fluid->set());
    max = std::max(max, measure(water).compression);
  });
  expect(std::sqrt(dot(drift, drift)) < 1e-3, "the drops' momentum per mass in m/s",
         std::sqrt(dot(drift, drift)));
  expect(max < 1e-3, "the drops' largest mean density error", max);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: dfsph_test PLUGIN\n");
    return 2;
  }
  try {
    runAll(argv[1]);
    return failures == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
