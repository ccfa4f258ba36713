// Two runs of a scene end in the same bits, whatever the device: all attributes of all particles, their
// order, and what solids felt.
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <map>

#include "framework/solids/solid.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "tests/support/devices.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

/// A splash: a block falls on still water, a nozzle pours, a drain takes particles away.
std::string splash(const std::string& modules, const std::string& nodes, const std::string& links) {
  return R"({"weir": 1, "world": {"dt": 0.004, "frame_rate": 50, "duration": 1},
    "nodes": {
      "pool": {"type": "BoxSampler", "params": {"min": [-0.2, 0, -0.2], "max": [0.2, 0.06, 0.2]}},
      "block": {"type": "BoxSampler", "params": {"min": [-0.1, 0.12, -0.1], "max": [0.05, 0.25, 0.05],
                                                 "velocity": [0.5, -2, 0]}},
      "nozzle": {"type": "SquareEmitter",
                 "params": {"position": [0.1, 0.3, 0.1], "width": 0.06, "height": 0.06, "speed": 2}},
      "drain": {"type": "Sink", "params": {"min": [0.15, 0, -0.2], "max": [0.2, 0.03, 0.2]}},
      "water": {"type": "ParticleFluid",
                "params": {"spacing": 0.02, "rest_steps": 0, "domain_max": [9, 0.4, 9]},
                "modules": {)" +
         modules + "}}" + nodes + R"(},
    "links": ["pool.particles -> water.initial", "block.particles -> water.initial",
              "nozzle.particles -> water.emitters", "drain.sink -> water.sinks")" +
         links + "]}";
}

const char* const kTank = R"(, "tank": {"type": "StaticBoundary", "params": {"shape": "box",
    "min": [-0.2, 0, -0.2], "max": [0.2, 0.6, 0.2], "inverted": true, "friction": 0.2}})";
const char* const kTankLink = R"(, "tank.boundary -> water.boundaries")";
const char* const kMeshes = R"(,
    "tub": {"type": "BoxMesh", "params": {"min": [-0.2, 0, -0.2], "max": [0.2, 0.6, 0.2]}},
    "ball": {"type": "TurningModel", "params": {"position": [0, 0.1, 0],
             "profile": [[0, -0.05], [0.05, 0], [0, 0.05]], "segments": 12}},
    "walls": {"type": "SemiAnalyticalSFI", "params": {"friction": 0.1}},
    "sides": {"type": "SemiAnalyticalSFI", "params": {"fill": "container"}})";
const char* const kMeshLinks = R"(, "ball.surface -> walls.solids", "water.fluid -> walls.fluid",
    "tub.surface -> sides.solids", "water.fluid -> sides.fluid")";

struct Scene {
  const char* name;
  std::string text;
};

std::vector<Scene> scenes() {
  const std::string tolerant =
      R"("solver": {"type": "AcceleratedSolver", "params": {"tolerance": 0.01, "max_iterations": 3}})";
  const std::string momentum =
      R"("solver": {"type": "AcceleratedSolver", "params": {"tolerance": 0.02, "max_iterations": 3, "acceleration": "nesterov"}})";
  const std::string conjugate =
      R"("solver": {"type": "AcceleratedSolver", "params": {"tolerance": 0.01, "max_iterations": 5, "acceleration": "conjugate"}})";
  const std::string plain = R"("solver": {"type": "SemiImplicitSolver"})";
  return {
      {"what a scene gets that says nothing", splash("", kTank, kTankLink)},
      {"walls of signed distance", splash(plain, kTank, kTankLink)},
      {"a tolerance", splash(tolerant, kTank, kTankLink)},
      {"a tolerance and mixtures", splash(momentum, kTank, kTankLink)},
      {"conjugate gradients", splash(conjugate, kTank, kTankLink)},
      {"conjugate gradients and meshes", splash(conjugate, kMeshes, kMeshLinks)},
      {"position based fluids", splash(R"("solver": {"type": "Pbf"})", kTank, kTankLink)},
      {"two projections", splash(R"("solver": {"type": "TwoProjections"})", kTank, kTankLink)},
      {"two projections and meshes", splash(R"("solver": {"type": "TwoProjections"})", kMeshes, kMeshLinks)},
      {"meshes", splash(plain, kMeshes, kMeshLinks)},
      {"meshes and a tolerance", splash(tolerant, kMeshes, kMeshLinks)}};
}

using Bits = std::map<std::string, std::vector<unsigned char>>;

template <class T>
void keep(Bits& bits, const std::string& name, const std::vector<T>& values) {
  std::vector<unsigned char>& to = bits[name];
  to.resize(values.size() * sizeof(T));
  if (!to.empty()) std::memcpy(to.data(), values.data(), to.size());
}

/// All that is known of a fluid.
Bits bitsOf(ParticleFluid& water) {
  ParticleSet& particles = water.fluid->set();
  const std::int64_t count = particles.refreshCount();
  Bits bits;
  for (const AttributeInfo& info : particles.attributes())
    withAttributeType(info.type, [&]<class T>(std::type_identity<T>) {
      keep(bits, info.name, particles.get<T>(info.name).toHost(count));
    });
  int number = 0;
  for (Solid* solid : water.solids()) {
    const SolidImpulse impulse = solid->impulse().toHost().front();
    keep(bits, "solid " + std::to_string(number++),
         std::vector<double>{impulse.linear.x, impulse.linear.y, impulse.linear.z, impulse.angular.x,
                             impulse.angular.y, impulse.angular.z});
  }
  return bits;
}

Bits run(Device& device, const std::string& text, int frames) {
  SimulatedScene scene(device, text);
  scene->reset();
  const std::atomic<bool> stop = false;
  for (int frame = 0; frame < frames; ++frame) scene->advanceFrame(stop);
  return bitsOf(scene.node<ParticleFluid>("water"));
}

using TwoRuns = OnDevice;
WEIR_ON_EVERY_DEVICE(TwoRuns);

TEST_P(TwoRuns, EndInTheSameBits) {
  constexpr int kFrames = 2;
  for (const Scene& scene : scenes()) {
    const Bits first = run(*device, scene.text, kFrames);
    const std::unique_ptr<Device> other = openDevice(GetParam());
    const Bits second = run(*other, scene.text, kFrames);
    ASSERT_EQ(first.size(), second.size());
    EXPECT_GT(first.at("position").size(), 800 * sizeof(Vec3f)) << scene.name;
    for (const auto& [name, bits] : first) EXPECT_TRUE(bits == second.at(name)) << scene.name << ": " << name;
  }
}

}  // namespace
}  // namespace weir::test
