// The centre of mass of a free ball of fluid must swing like a mass on a spring, x(t) = x(0)·cos(rate·t),
// whatever happens within the fluid, because its own forces cancel. And a run that is resumed from a
// checkpoint must go on as one that was not.
//
// Takes the plugin's file as its argument; ends with 0 if all is well.
#include <cmath>
#include <cstdio>

#include <weir/particle_fluid.h>
#include <weir/plugin.h>
#include <weir/simulation.h>

namespace {

using namespace weir;

constexpr const char* kScene = R"({
  "weir": 1,
  "world": { "gravity": [0, 0, 0], "dt": 0.002, "frame_rate": 10, "duration": 0.4 },
  "nodes": {
    "ball": { "type": "SphereSampler", "params": { "center": [0.3, 0, 0], "radius": 0.1 } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.025 },
               "modules": { "pull": { "type": "MyPluginPull", "before": "predict",
                                      "params": { "center": [0, 0, 0], "rate": 6 } } } },
    "probe": { "type": "MyPluginProbe", "params": { "min": [-1, -1, -1], "max": [1, 1, 1] } }
  },
  "links": ["ball.particles -> water.initial", "water.fluid -> probe.fluid"]
})";

double meanX(const ParticleSet& particles) {
  double sum = 0;
  const std::vector<Vec3f> positions = particles.positions().toHost(particles.bound());
  for (const Vec3f& p : positions) sum += p.x;
  return sum / double(positions.size());
}

int run(const char* pluginFile) {
  constexpr double kRate = 6;
  Registry registry;
  registerNodes(registry);
  const Plugin plugin(pluginFile, registry);
  const auto device = openDevice("auto");
  device->setDeterministic(true);
  Log log;
  const auto make = [&] {
    std::vector<std::string> warnings;
    auto scene = buildScene(parseJson(kScene, "test"), {"test", "", "."}, registry, {}, warnings);
    return std::make_unique<Simulation>(std::move(scene), *device, log, registry);
  };
  int wrong = 0;
  {
    const auto made = make();
    Simulation& simulation = *made;
    simulation.reset();
    auto& water = dynamic_cast<ParticleFluid&>(*simulation.scene().graph.find("water"));
    const double start = meanX(water.fluid->set());
    const std::atomic<bool> never = false;
    while (simulation.advanceFrame(never)) {
      const double found = meanX(water.fluid->set());
      const double expected = start * std::cos(kRate * simulation.time());
      const bool right = std::abs(found - expected) < 0.02 * start;
      if (!right) ++wrong;
      std::printf("t = %.1f s: centre at %.4f m, expected %.4f m%s\n", simulation.time(), found, expected,
                  right ? "" : "  WRONG");
    }
  }
  // What a node or module keeps in other members than State is missing after a resume.
  for (const std::string& difference : resumeDifferences(make, {.savedAt = 2, .comparedFor = 2})) {
    ++wrong;
    std::printf("a resumed run goes on differently, WRONG: %s\n", difference.c_str());
  }
  return wrong == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: my_plugin_test PLUGIN\n");
    return 2;
  }
  try {
    return run(argv[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
