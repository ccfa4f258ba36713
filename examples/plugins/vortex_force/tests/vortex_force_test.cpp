// One step with the vortex alone: the change of every velocity against the closed form, in double precision.
//
// Takes the plugin's file as its argument; ends with 0 if all is well.
#include <cmath>
#include <cstdio>
#include <numbers>

#include <weir/particle_fluid.h>
#include <weir/plugin.h>
#include <weir/simulation.h>

namespace {

using namespace weir;

// All other modules are off, so particles stay where they are.
constexpr const char* kScene = R"({
  "weir": 1,
  "world": { "gravity": [0, 0, 0], "dt": 0.01, "frame_rate": 100, "duration": 0.01 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [-0.5, -0.1, -0.3], "max": [0.5, 0.2, 0.4] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.05, "rest_steps": 0 },
               "modules": {
                 "vortex": { "type": "VortexForce", "before": "predict",
                             "params": { "center": [0.1, 0, -0.05], "axis": [1, 2, 2], "growth": 3, "core": 0.1 } },
                 "predict": { "enabled": false }, "solver": { "enabled": false },
                 "viscosity": { "enabled": false } } }
  },
  "links": ["block.particles -> water.initial"]
})";

Vec3d expectedAcceleration(const Vec3f& position) {
  constexpr double kGrowth = 3, kCore = 0.1;
  const Vec3d axis{1 / 3.0, 2 / 3.0, 2 / 3.0};
  const Vec3d d{position.x - 0.1, position.y - 0.0, position.z + 0.05};
  const Vec3d s = d - dot(d, axis) * axis;
  const double distance = std::sqrt(dot(s, s));
  if (distance < 1e-9) return {};
  const double size =
      kGrowth / (2 * std::numbers::pi * distance) * (1 - std::exp(-distance * distance / (kCore * kCore)));
  const Vec3d t{axis.y * s.z - axis.z * s.y, axis.z * s.x - axis.x * s.z, axis.x * s.y - axis.y * s.x};
  return (size / distance) * t;
}

int run(const char* pluginFile) {
  constexpr double kDt = 0.01;
  Registry registry;
  registerNodes(registry);
  const Plugin plugin(pluginFile, registry);
  std::vector<std::string> warnings;
  auto scene = buildScene(parseJson(kScene, "test"), {"test", "", "."}, registry, {}, warnings);
  const auto device = openDevice("auto");
  Log log;
  Simulation simulation(std::move(scene), *device, log, registry);
  simulation.reset();
  auto& water = dynamic_cast<ParticleFluid&>(*simulation.scene().graph.find("water"));
  const std::atomic<bool> never = false;
  simulation.advanceFrame(never);

  const ParticleSet& particles = water.fluid->set();
  const auto positions = particles.positions().toHost(particles.bound());
  const auto velocities = particles.velocities().toHost(particles.bound());
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3d a = expectedAcceleration(positions[i]);
    const Vec3d off{velocities[i].x - kDt * a.x, velocities[i].y - kDt * a.y, velocities[i].z - kDt * a.z};
    worst = std::max(worst, std::sqrt(dot(off, off)));
    largest = std::max(largest, kDt * std::sqrt(dot(a, a)));
  }
  std::printf("%zu particles, speeds up to %.3g m/s, off by at most %.2g m/s\n", positions.size(), largest,
              worst);
  return positions.size() > 1000 && largest > 0.01 && worst < 1e-5 * largest ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: vortex_force_test PLUGIN\n");
    return 2;
  }
  try {
    return run(argv[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
