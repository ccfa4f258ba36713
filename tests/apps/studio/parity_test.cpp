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

std::string stateOf(const Socket& socket, std::int64_t count) {
  std::string state;
  for (std::int64_t id = 0; id < count; ++id) {
    Value request = parseJson(R"({"id": 8, "do": "particle", "node": "water"})", "request");
    request["particle"] = id;
    state += writeJsonLine(*socket.ask(request).find("result")) + "\n";
  }
  return state;
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
  EXPECT_EQ(stateOf(socket, count), stateOf(simulation, count));
}

Value edited(const Socket& socket, const std::function<void(Value& scene)>& change) {
  Value set = parseJson(R"({"id": 10, "do": "scene.set"})", "request");
  set["scene"] = parseJson(kScene, "scene");
  change(set["scene"]);
  return socket.ask(set);
}

/// Goes on from a frame, or an earlier one that is kept, and to the end, with a rate of viscosity where one
/// is given.
std::string stateAfter(const Socket& socket, std::int64_t frame, std::optional<double> rate,
                       std::int64_t count) {
  const Value set = edited(socket, [&](Value& scene) {
    Value params = Value::object(), module = Value::object(), modules = Value::object();
    params["rate"] = rate.value_or(0);
    module["params"] = params;
    modules["viscosity"] = module;
    if (rate) scene["nodes"]["water"]["modules"] = modules;
  });
  EXPECT_EQ(set.find("result")->find("problem"), nullptr);
  Value goOn = parseJson(R"({"id": 11, "do": "run.go_on"})", "request");
  goOn["frame"] = frame;
  EXPECT_NE(socket.ask(goOn).find("result"), nullptr);
  EXPECT_LE(socket.state("paused").find("frame")->asInt(), frame);
  socket.ask(R"({"id": 12, "do": "run.play"})");
  EXPECT_FALSE(socket.state("finished").isNull());
  return stateOf(socket, count);
}

TEST(StudioParity, ARunThatGoesOnFromAFrameIsTheRunItWas) {
  const test::TemporaryFolder folder;
  folder.write("scene.json", kScene);
  StudioOptions options;
  options.folder = folder.path();
  options.threads = 1;
  const RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  EXPECT_NE(socket.ask(R"({"id": 1, "do": "run.go_on", "frame": 0})").find("error"), nullptr);
  socket.ask(R"({"id": 2, "do": "run.play"})");
  const Value end = socket.state("finished");
  ASSERT_FALSE(end.isNull());
  const std::int64_t count = end.find("particles")->asInt();
  ASSERT_GT(count, 100);
  const std::string once = stateOf(socket, count);
  const std::int64_t middle = 3;
  EXPECT_EQ(stateAfter(socket, middle, {}, count), once);
  EXPECT_NE(stateAfter(socket, middle, 500, count), once);
  // What came after that frame of another branch leaves nothing behind.
  EXPECT_EQ(stateAfter(socket, middle, {}, count), once);
  edited(socket, [](Value& scene) { scene["nodes"]["water"]["params"]["spacing"] = 0.05; });
  const Value refused = socket.ask(R"({"id": 21, "do": "run.go_on", "frame": 1})");
  EXPECT_NE(refused.find("error")->find("message")->asString().find("water.spacing"), std::string::npos);
}

}  // namespace
}  // namespace weir::studio
