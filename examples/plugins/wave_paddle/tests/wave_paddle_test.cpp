// The paddle goes where it shall, not faster than its drive can, and the fluid stays in front of it.
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

namespace {

using namespace weir;

constexpr const char* kScene = R"({
  "weir": 1,
  "world": { "dt": 0.004, "frame_rate": 50, "duration": 0.5 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.4, 0.15, 0.15] } },
    "walls": { "type": "BoxMesh", "params": { "min": [-0.15, 0, 0], "max": [0.5, 0.4, 0.15] } },
    "tank": { "type": "SemiAnalyticalSFI", "params": { "fill": "container" } },
    "board": { "type": "BoxMesh", "params": { "min": [-0.06, -0.02, -0.02], "max": [0, 0.5, 0.17] } },
    "paddle": { "type": "WavePaddle", "params": { "stroke": 0.1, "period": 0.5, "ramp": 0.2, ACCELERATION } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.03 } }
  },
  "links": ["block.particles -> water.initial", "water.fluid -> tank.fluid", "walls.surface -> tank.solids",
            "water.fluid -> paddle.fluid", "board.surface -> paddle.solids"]
})";

int failures = 0;

void expect(bool holds, const char* what, double time, double found, double expected) {
  if (holds) return;
  ++failures;
  std::printf("WRONG at t = %.2f s: %s is %.6g, expected %.6g\n", time, what, found, expected);
}

double wanted(double t) {
  return std::min(t / 0.2, 1.0) * 0.05 * std::sin(2 * std::numbers::pi * t / 0.5);
}

double minX(const ParticleSet& particles) {
  double min = 1e9;
  for (const Vec3f& p : particles.positions().toHost(particles.bound())) min = std::min(min, double(p.x));
  return min;
}

void run(const char* pluginFile, double maxAcceleration, bool follows) {
  Registry registry;
  registerNodes(registry);
  const Plugin plugin(pluginFile, registry);
  std::string text = kScene;
  const std::string key = "ACCELERATION";
  text.replace(text.find(key), key.size(), "\"acceleration\": " + std::to_string(maxAcceleration));
  std::vector<std::string> warnings;
  auto scene = buildScene(parseJson(text, "test"), {"test", "", "."}, registry, {}, warnings);
  const auto device = openDevice("auto");
  Log log;
  Simulation simulation(std::move(scene), *device, log, registry);
  simulation.reset();
  auto& water = dynamic_cast<ParticleFluid&>(*simulation.scene().graph.find("water"));
  Node& paddle = *simulation.scene().graph.find("paddle");
  const std::atomic<bool> never = false;
  double velocityBefore = 0, timeBefore = 0, farthest = 0;
  while (simulation.advanceFrame(never)) {
    const double t = simulation.time();
    NodeReport report;
    paddle.report(report);
    const double x = report.statistics.find("position")->asDouble();
    const double v = report.statistics.find("velocity")->asDouble();
    farthest = std::max(farthest, std::abs(x - wanted(t)));
    if (follows) expect(std::abs(x - wanted(t)) < 1e-9, "the position", t, x, wanted(t));
    const double max = maxAcceleration * (t - timeBefore) * (1 + 1e-9);
    if (timeBefore > 0)
      expect(std::abs(v - velocityBefore) <= max, "the change of velocity", t, v - velocityBefore, max);
    expect(minX(water.fluid->set()) > x, "the fluid's edge", t, minX(water.fluid->set()), x);
    velocityBefore = v;
    timeBefore = t;
  }
  // A weak drive cannot keep up.
  if (!follows) expect(farthest > 0.005, "how far it lags", timeBefore, farthest, 0.005);
  std::printf("acceleration up to %g m/s^2: at most %.2g m from where it shall be\n", maxAcceleration,
              farthest);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: wave_paddle_test PLUGIN\n");
    return 2;
  }
  try {
    run(argv[1], 1000, true);
    run(argv[1], 4, false);
    return failures == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
