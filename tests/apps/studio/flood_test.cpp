// Windows that ask without end, or hold connections open: the simulation, the others and the end do not wait.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <fstream>

#include "apps/studio/session/question_queue.h"
#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

/// 8000 particles that fall for long.
constexpr const char* kLongScene = R"({
  "weir": 1, "world": { "duration": 1000, "frame_rate": 1 , "dt": 0.001 },
  "nodes": { "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.8, 0.8, 0.8] } },
             "water": { "type": "ParticleFluid", "params": { "spacing": 0.04, "rest_steps": 0 } } },
  "links": ["block.particles -> water.initial"]
})";

class FloodTest : public testing::Test {
 protected:
  FloodTest() {
    folder.write("scene.json", kLongScene);
    options.folder = folder.path();
    options.threads = 1;
  }
  static std::int64_t stepsOf(const Socket& socket) {
    return socket.event("status", [](const Value&) { return true; }).find("steps")->asInt();
  }
  /// Sends that many requests at once.
  static void flood(const Socket& socket, std::string_view request, int count) {
    std::string frames;
    for (int i = 0; i < count; ++i) frames += Socket::frameOf(request);
    socket.sendRaw(frames);
  }

  test::TemporaryFolder folder;
  StudioOptions options;
};

constexpr const char* kQuestion = R"({"id":1,"do":"particles","node":"water","sort":"speed","count":1000})";

TEST_F(FloodTest, AViewerWithoutThePenDoesNotStopTheSteps) {
  const RunningStudio studio(options, "scene.json");
  const Socket writer = studio.socket();
  writer.ask(R"({"id": 1, "do": "hello"})");
  writer.ask(R"({"id": 2, "do": "run.play"})");
  writer.state("playing");
  const Socket viewer = studio.socket();
  flood(viewer, kQuestion, 2000);
  // Some are refused with a reason, and the steps go on between two answers.
  bool refused = false;
  while (!refused) {
    const auto message = viewer.next();
    ASSERT_TRUE(message);
    if (!message->text) continue;
    const Value value = parseJson(message->data, "answer");
    if (const Value* error = value.find("error")) {
      EXPECT_NE(error->find("message")->asString().find("asks faster"), std::string::npos);
      refused = true;
    }
  }
  const std::int64_t before = stepsOf(writer);
  int between = 0;
  for (std::int64_t steps = before; steps < before + 20; ++between) {
    ASSERT_LT(between, 1000);
    steps = stepsOf(writer);
  }
}

TEST_F(FloodTest, WhatAWindowHasAskedGoesWithIt) {
  const RunningStudio studio(options, "scene.json");
  const Socket writer = studio.socket();
  writer.ask(R"({"id": 1, "do": "hello"})");
  writer.ask(R"({"id": 2, "do": "run.play"})");
  writer.state("playing");
  for (int i = 0; i < 20; ++i) {
    const Socket viewer = studio.socket();
    flood(viewer, kQuestion, QuestionQueue::kMaxOfAClient);
  }
  // The writer's question waits for nobody else's: those that came before it are gone, or take turns with it.
  EXPECT_NE(writer.ask(R"({"id": 3, "do": "particle", "node": "water", "particle": 0})").find("result"),
            nullptr);
}

TEST_F(FloodTest, TheEndWaitsForNobody) {
  std::vector<std::unique_ptr<Socket>> viewers;
  const auto start = std::chrono::steady_clock::now();
  {
    const RunningStudio studio(options, "scene.json");
    const Socket writer = studio.socket();
    writer.ask(R"({"id": 2, "do": "run.play"})");
    for (int i = 0; i < 4; ++i) {
      viewers.push_back(
          std::make_unique<Socket>(studio.port(), studio.head("GET /api/live", studio.bearer())));
      flood(*viewers.back(), kQuestion, 500);
    }
    writer.state("playing");
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

TEST_F(FloodTest, ConnectionsThatSayNothingKeepNobodyOut) {
  const RunningStudio studio(options, "scene.json");
  std::vector<std::unique_ptr<Connection>> silent;
  for (int i = 0; i < 200; ++i) {
    silent.push_back(std::make_unique<Connection>(studio.port()));
    silent.back()->send("GET / HTTP/1.1\r\n");
  }
  const auto start = std::chrono::steady_clock::now();
  const Socket socket = studio.socket();
  EXPECT_TRUE(socket.accepted());
  EXPECT_NE(socket.ask(R"({"id": 1, "do": "hello"})").find("result"), nullptr);
  // Before the silent ones' time for a header is over.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(9));
}

TEST_F(FloodTest, WithoutDescriptorsTheServerRests) {
  RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  socket.ask(R"({"id": 1, "do": "hello"})");
  rlimit usual{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &usual), 0);
  // All descriptors but one are taken; the one is the client's, so that the server has none for its side.
  const int next = open("/dev/null", O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(close(next), 0);
  rlimit few = usual;
  few.rlim_cur = static_cast<rlim_t>(next) + 1;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  double used = 0;
  {
    const Connection waiting(studio.port());
    const double before = studio.servingSeconds();
    std::this_thread::sleep_for(std::chrono::seconds(1));
    used = studio.servingSeconds() - before;
    EXPECT_NE(socket.ask(R"({"id": 2, "do": "hello"})").find("id"), nullptr);  // others are served
  }
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &usual), 0);
  EXPECT_LT(used, 0.3);  // of a second; the whole of it, if it tries again and again
  EXPECT_TRUE(studio.socket().accepted());
}

std::int64_t peakBytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      std::int64_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes << 10;
    }
  return 0;
}

TEST_F(FloodTest, ALargeMessageIsRefusedBeforeItTakesMemory) {
  constexpr std::int64_t kSpare = std::int64_t{120} << 20;
  const RunningStudio studio(options, "scene.json");
  const Socket writer = studio.socket(), viewer = studio.socket();
  writer.ask(R"({"id": 1, "do": "hello"})");
  std::string scene = R"({"id": 2, "do": "scene.set", "scene": {"weir": 1, "nodes": [0)";
  for (int i = 0; i < 7'500'000; ++i) scene += ",0";
  scene += "]}}";
  const std::string frame = Socket::frameOf(scene);
  std::ofstream("/proc/self/clear_refs") << 5;  // the peak begins anew
  const std::int64_t before = peakBytes();
  for (const Socket* socket : {&writer, &viewer}) {
    ASSERT_TRUE(socket->sendRaw(frame));
    const Value answer = socket->answer(2);
    ASSERT_NE(answer.find("error"), nullptr);
    EXPECT_NE(
        answer.find("error")->find("message")->asString().find(socket == &writer ? "too many values" : "pen"),
        std::string::npos);
  }
  EXPECT_LT(peakBytes() - before, kSpare);
}

TEST_F(FloodTest, EveryRefusalNamesItsRequest) {
  const RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  for (const char* bad : {R"({"id": 7, "do": "scene.set", "scene": {"g": -100000000000000000000}})",
                          R"({"id": 7, "do": "scene.set", "scene": {)", R"( { "id" : 7 ,)", R"({"id": 7})"}) {
    ASSERT_TRUE(socket.sendText(bad));
    EXPECT_NE(socket.answer(7).find("error"), nullptr) << bad;
  }
}

TEST_F(FloodTest, PlayBeginsAnewAfterTheEndAndAfterAFailure) {
  folder.write("scene.json", kBriefScene);
  const RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  for (int i = 0; i < 2; ++i) {
    socket.sendText(R"({"id": 1, "do": "run.play"})");
    socket.state("playing");
    socket.state("finished");
  }
  // A scene that cannot be built: a boundary without a shape. Then one that can.
  Value set = parseJson(R"({"id": 2, "do": "scene.set"})", "request");
  set["scene"] = parseJson(kBriefScene, "scene");
  Value& scene = set["scene"];
  scene["nodes"]["tank"]["type"] = "StaticBoundary";
  scene["links"].push("tank.boundary -> water.boundaries");
  socket.ask(set);
  socket.sendText(R"({"id": 3, "do": "run.play"})");
  socket.state("failed");
  scene["nodes"]["tank"]["params"]["shape"] = "box";
  scene["nodes"]["tank"]["params"]["inverted"] = true;
  socket.ask(set);
  socket.sendText(R"({"id": 4, "do": "run.play"})");
  EXPECT_FALSE(socket.state("finished").isNull());
}

}  // namespace
}  // namespace weir::studio
