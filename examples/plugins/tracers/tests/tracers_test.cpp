// Each tracer stays on its circle and has turned by Ω(r)·t.
//
// Takes the plugin's file as its argument; ends with 0 if all is well.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include <weir/output.h>
#include <weir/particles.h>
#include <weir/plugin.h>
#include <weir/simulation.h>

namespace {

using namespace weir;

constexpr const char* kScene = R"({
  "weir": 1,
  "world": { "dt": 0.01, "frame_rate": 10, "duration": 1 },
  "nodes": {
    "strip": { "type": "BoxSampler", "params": { "min": [-0.5, 0, -0.1], "max": [0.5, 0.1, 0.1] } },
    "vortex": { "type": "VortexTracers",
                "params": { "spacing": 0.05, "center": [0.1, 0, 0], "circulation": 0.6, "core": 0.2 } }
  },
  "links": ["strip.particles -> vortex.initial"]
})";

constexpr double kCenter = 0.1, kCirculation = 0.6, kCore = 0.2;

std::map<std::int64_t, Vec3f> positionsById(const Particles& particles) {
  const ParticleSet& set = particles.set();
  const std::vector<std::int64_t> ids = set.ids().toHost(set.bound());
  const std::vector<Vec3f> positions = set.positions().toHost(set.bound());
  std::map<std::int64_t, Vec3f> byId;
  for (std::size_t i = 0; i < ids.size(); ++i) byId[ids[i]] = positions[i];
  return byId;
}

/// Where a tracer that started at p is at the time t.
Vec3d expected(const Vec3f& p, double t) {
  const double x = p.x - kCenter, z = p.z, square = x * x + z * z;
  const double rate =
      kCirculation / (2 * std::numbers::pi * square) * (1 - std::exp(-square / (kCore * kCore)));
  // About y: z turns into x.
  const double c = std::cos(rate * t), s = std::sin(rate * t);
  return {kCenter + c * x + s * z, p.y, c * z - s * x};
}

double largestError(const char* pluginFile) {
  Registry registry;
  registerNodes(registry);
  const Plugin plugin(pluginFile, registry);
  std::vector<std::string> warnings;
  auto scene = buildScene(parseJson(kScene, "test"), {"test", "", "."}, registry, {}, warnings);
  const auto device = openDevice("auto");
  Log log;
  Simulation simulation(std::move(scene), *device, log, registry);
  simulation.reset();
  const auto outputs = outputsOf<Particles>(simulation.scene().graph);
  const Particles& tracers = **outputs.at(0).second;
  const std::map<std::int64_t, Vec3f> start = positionsById(tracers);
  const std::atomic<bool> never = false;
  double largest = start.size() == 160 ? 0 : 1;
  while (simulation.advanceFrame(never))
    for (const auto& [id, p] : positionsById(tracers)) {
      const Vec3d at = expected(start.at(id), simulation.time());
      largest = std::max(largest, std::hypot(p.x - at.x, p.y - at.y, p.z - at.z));
    }
  return largest;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: tracers_test PLUGIN\n");
    return 2;
  }
  try {
    const double error = largestError(argv[1]);
    std::printf("the tracers are at most %.2g m from where they shall be\n", error);
    return error < 1e-5 ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
