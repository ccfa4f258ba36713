// A scene that runs in the studio, watched and interrupted, ends as the same one in `weir run`, bit for bit.
#include <gtest/gtest.h>

#include "apps/studio/session/particle_values.h"
#include "framework/run/run.h"
#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

// Particles enter, flow around a wall and are not at rest at the end.
constexpr const char* kScene = R"({
  "weir": 1, "world": { "duration": 0.12, "frame_rate": 50 },
  "nodes": { "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.3, 0.2] } },
             "tank": { "type": "StaticBoundary",
                       "params": { "shape": "box", "min": [0, 0, 0], "max": [0.5, 0.6, 0.2], "inverted": true } },
             "water": { "type": "ParticleFluid", "params": { "spacing": 0.04, "rest_steps": 0 } } },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"]
})";

/// All particles with all their attributes. Numbers are written so that reading gives the same bits.
std::string stateOf(const Simulation& simulation, std::int64_t count) {
  std::string text;
  for (std::int64_t id = 0; id < count; ++id)
    text += writeJsonLine(particleValue(simulation, "water", id)) + "\n";
  return text;
}

TEST(StudioParity, TheRunIsThatOfTheCommandLine) {
  const test::TemporaryFolder folder;
  folder.write("scene.json", kScene);
  Registry registry;
  registerNodes(registry);
  Log log;
  const auto device = openDevice("cpu", 2);
  std::vector<std::string> warnings;
  Simulation simulation(loadScene(folder / "scene.json", registry, {}, warnings), *device, log, registry);
  ASSERT_EQ(runSimulation(simulation, {}), RunEnd::kFinished);
  const std::int64_t count = simulation.particleCount();
  ASSERT_GT(count, 100);

  StudioOptions options;
  options.folder = folder.path();
  options.threads = 1;
  const RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  socket.ask(R"({"id": 1, "do": "hello"})");
  // It pauses, looks at particles in the middle of frames, and goes on.
  for (int i = 0; i < 5; ++i) {
    socket.ask(R"({"id": 2, "do": "run.play"})");
    socket.ask(R"({"id": 3, "do": "particle", "node": "water", "particle": 5})");
    socket.ask(R"({"id": 4, "do": "view.set", "attribute": "density", "most": 50})");
    socket.ask(R"({"id": 5, "do": "run.pause"})");
    socket.ask(R"({"id": 6, "do": "particle", "node": "water", "particle": 6})");
  }
  socket.sendText(R"({"id": 7, "do": "run.play"})");
  ASSERT_FALSE(socket.state("finished").isNull());
  std::string state;
  for (std::int64_t id = 0; id < count; ++id) {
    Value request = parseJson(R"({"id": 8, "do": "particle", "node": "water"})", "request");
    request["particle"] = id;
    state += writeJsonLine(*socket.ask(request).find("result")) + "\n";
  }
  EXPECT_EQ(state, stateOf(simulation, count));
}

}  // namespace
}  // namespace weir::studio
