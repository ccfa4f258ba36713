// The studio as a browser sees it: HTTP and WebSocket, over a real connection.
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <thread>

#include "framework/base/interruption.h"
#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

/// Is set up without end, until nobody wants it any more.
class Endless final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Endless", "Never ready."};
  const NodeInfo& info() const override { return kInfo; }
  void reset(const SetupContext&) override {
    for (;;) {
      InterruptibleWork::endIfAsked();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
};

class StudioTest : public testing::Test {
 protected:
  StudioTest() {
    folder.write("scene.json", kBriefScene);
    StudioOptions options;
    options.folder = folder.path();
    options.page = folder / "page";
    options.templates = folder / "templates";
    options.types = "{}";
    options.threads = 1;
    studio = std::make_unique<RunningStudio>(options, "scene.json",
                                             [](Registry& registry) { registry.addNode<Endless>(); });
    port = studio->port();
    token = studio->token();
  }

  std::string head(const std::string& first, const std::string& more = "") const {
    return studio->head(first, more);
  }
  std::string bearer() const { return studio->bearer(); }
  int status(const std::string& request) const { return studio->status(request); }

  test::TemporaryFolder folder;
  std::unique_ptr<RunningStudio> studio;
  int port = 0;
  std::string token;
};

TEST_F(StudioTest, AnswersOnlyThoseWhoMayAsk) {
  EXPECT_EQ(status(head("GET /api/types", bearer()) + "\r\n"), 200);
  EXPECT_EQ(status(head("GET /api/types") + "\r\n"), 401);
  EXPECT_EQ(status(head("GET /?token=" + token) + "\r\n"), 303);
  EXPECT_EQ(status(head("GET /?token=wrong") + "\r\n"), 401);
  EXPECT_EQ(status(head("GET /api/types", bearer() + "Origin: http://evil.example\r\n") + "\r\n"), 403);
  EXPECT_EQ(status("GET /api/types HTTP/1.1\r\nHost: evil.example\r\n" + bearer() + "\r\n"), 403);
  EXPECT_EQ(status(head("GET /api/file/..%2f..%2fetc/passwd", bearer()) + "\r\n"), 400);
  EXPECT_EQ(status(head("GET /api/nothing", bearer()) + "\r\n"), 404);
  EXPECT_EQ(status(head("PUT /api/file/big.obj", bearer() + "Content-Length: 1073741824\r\n") + "\r\n"), 413);
  EXPECT_EQ(status(head("PUT /api/file/a.obj", bearer() + "Content-Length: 2\r\n") + "\r\nv\n"), 200);
  EXPECT_FALSE(Socket(port, head("GET /api/live")).accepted());
  EXPECT_FALSE(Socket(port, head("GET /api/live", bearer() + "Origin: http://evil.example\r\n")).accepted());
}

TEST_F(StudioTest, RunsASceneAndStreamsItsFrames) {
  const Socket socket(port, head("GET /api/live", bearer()));
  ASSERT_TRUE(socket.accepted());
  socket.sendText(R"({"id": 1, "do": "hello"})");
  const Value hello = socket.answer(1);
  EXPECT_EQ(hello.find("result")->find("role")->asString(), "writer");
  EXPECT_NE(hello.find("result")->find("scene")->find("scene")->find("nodes")->find("water"), nullptr);
  socket.sendText(R"({"id": 2, "do": "run.play"})");
  int frames = 0;
  std::string state;
  while (state != "finished") {
    const auto message = socket.next();
    ASSERT_TRUE(message);
    if (!message->text) {
      std::uint32_t length = 0;
      std::memcpy(&length, message->data.data(), sizeof length);
      const Value header = parseJson(message->data.substr(4, length), "packet");
      if (header.find("kind")->asString() != "frame") continue;
      ++frames;
      EXPECT_EQ(header.find("fluids")->asArray().at(0).find("count")->asInt(), 125);
      socket.sendText(R"({"do": "frame.seen"})");
      continue;
    }
    const Value value = parseJson(message->data, "event");
    const Value* event = value.find("event");
    if (event != nullptr && event->asString() == "status")
      state = value.find("data")->find("state")->asString();
  }
  EXPECT_GE(frames, 2);
  EXPECT_LE(frames, 5);
}

TEST_F(StudioTest, TellsThatASceneIsBeingBuilt) {
  const Socket socket = studio->socket();
  for (int round = 0; round < 2; ++round) {
    socket.sendText(R"({"id": 1, "do": "run.reset"})");
    const Value building =
        socket.event("status", [](const Value& data) { return data.find("state")->asString() != "paused"; });
    EXPECT_EQ(building.find("state")->asString(), "building");
    const Value built = socket.event(
        "status", [](const Value& data) { return data.find("state")->asString() != "building"; });
    EXPECT_EQ(built.find("state")->asString(), "paused");
    EXPECT_EQ(built.find("frame")->asInt(), 0);
  }
}

constexpr const char* kSetEndless =
    R"({"id": 1, "do": "scene.set", "scene": {"weir": 1, "nodes": {"slow": {"type": "Endless"}}}})";

TEST_F(StudioTest, TellsWhichNodeIsSetUpAndGivesUpWhenAsked) {
  const Socket socket = studio->socket();
  socket.ask(kSetEndless);
  socket.ask(R"({"id": 2, "do": "run.reset"})");
  const Value status =
      socket.event("status", [](const Value& data) { return data.find("building") != nullptr; });
  EXPECT_EQ(status.find("state")->asString(), "building");
  const Value& building = *status.find("building");
  EXPECT_EQ(building.find("node")->asString(), "slow");
  EXPECT_EQ(building.find("done")->asInt(), 0);
  EXPECT_EQ(building.find("all")->asInt(), 1);
  const Socket viewer = studio->socket();
  EXPECT_NE(viewer.ask(R"({"id": 1, "do": "run.cancel"})").find("error"), nullptr);
  socket.ask(R"({"id": 3, "do": "run.cancel"})");
  const Value after =
      socket.event("status", [](const Value& data) { return data.find("state")->asString() != "building"; });
  EXPECT_EQ(after.find("state")->asString(), "empty");
  EXPECT_EQ(after.find("problem"), nullptr);
}

TEST_F(StudioTest, ASceneThatIsBuiltMakesWayForTheNextOne) {
  const Socket socket = studio->socket();
  socket.ask(kSetEndless);
  socket.ask(R"({"id": 2, "do": "run.reset"})");
  socket.event("status", [](const Value& data) { return data.find("building") != nullptr; });
  Value set = parseJson(R"({"id": 3, "do": "scene.set"})", "message");
  set["scene"] = parseJson(kBriefScene, "scene");
  socket.ask(set);
  socket.ask(R"({"id": 4, "do": "run.reset"})");
  const Value after =
      socket.event("status", [](const Value& data) { return data.find("state")->asString() != "building"; });
  EXPECT_EQ(after.find("state")->asString(), "paused");
  EXPECT_EQ(after.find("particles")->asInt(), 125);
}

TEST_F(StudioTest, PlayThatComesWhileASceneIsBuiltIsRemembered) {
  const Socket socket = studio->socket();
  const auto reset = [&](bool endless) {
    Value message = parseJson(R"({"id": 1, "do": "run.reset"})", "request");
    message["scene"] = parseJson(kBriefScene, "scene");
    if (endless) message["scene"]["nodes"]["endless"]["type"] = "Endless";
    socket.ask(message);
  };
  const auto plays = [&](bool expected) {
    socket.event("status", [&](const Value& status) {
      return status.find("state")->asString() == "building" && *status.find("plays") == Value(expected);
    });
  };
  reset(true);
  socket.sendText(R"({"do": "run.play"})");
  plays(true);
  reset(false);  // such as the page's own, of a scene that was just opened
  socket.state("finished");
  // It is taken back by Pause, and is for one run.
  reset(true);
  socket.sendText(R"({"do": "run.play"})");
  plays(true);
  socket.sendText(R"({"do": "run.pause"})");
  plays(false);
  reset(false);
  socket.state("paused");
  reset(false);
  socket.state("paused");
  socket.sendText(R"({"id": 5, "do": "run.play"})");
  socket.state("finished");
}

TEST_F(StudioTest, ARunThatIsNotBuiltCannotBeCancelled) {
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  socket.state("paused");
  socket.ask(R"({"id": 2, "do": "run.cancel"})");
  socket.ask(R"({"id": 3, "do": "run.step"})");
  const Value status = socket.event("status", [](const Value& data) {
    return data.find("state")->asString() == "paused" && *data.find("frame") == Value(1);
  });
  EXPECT_EQ(status.find("recorded_every")->asInt(), 1);
}

TEST(StudioMemory, TellsWhichFramesAreKept) {
  const test::TemporaryFolder folder;
  folder.write("scene.json", kBriefScene);
  StudioOptions options;
  options.folder = folder.path();
  options.threads = 1;
  options.maxRecordedBytes = 1;
  const RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  socket.ask(R"({"id": 1, "do": "run.play"})");
  const Value status =
      socket.event("status", [](const Value& data) { return data.find("state")->asString() == "finished"; });
  EXPECT_EQ(status.find("frame")->asInt(), 4);
  // Frame 0 alone has room: each other one halves what is kept, down to every eighth.
  EXPECT_EQ(status.find("recorded_every")->asInt(), 8);
}

TEST_F(StudioTest, EachStepIsAFrameHoweverQuicklyTheyCome) {
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  for (int i = 0; i < 3; ++i) socket.sendText(R"({"id": 2, "do": "run.step"})");
  // Whether one is done before the next one comes or not.
  socket.event("status", [](const Value& data) {
    return data.find("state")->asString() == "paused" && *data.find("frame") == Value(3);
  });
  socket.ask(R"({"id": 3, "do": "particles", "node": "water"})");  // which the simulation answers
  const Value hello = socket.ask(R"({"id": 4, "do": "hello"})");
  EXPECT_EQ(hello.find("result")->find("status")->find("frame")->asInt(), 3);
}

TEST_F(StudioTest, OneWindowHasThePen) {
  const Socket first(port, head("GET /api/live", bearer()));
  first.sendText(R"({"id": 1, "do": "hello"})");
  first.answer(1);
  const Socket second(port, head("GET /api/live", bearer()));
  second.sendText(R"({"id": 1, "do": "hello"})");
  EXPECT_EQ(second.answer(1).find("result")->find("role")->asString(), "viewer");
  second.sendText(R"({"id": 2, "do": "run.play"})");
  EXPECT_NE(second.answer(2).find("error"), nullptr);
  second.sendText(R"({"id": 3, "do": "role.claim"})");
  second.answer(3);
  second.sendText(R"({"id": 4, "do": "scene.set", "scene": {"weir": 1, "nodes": {"x": {"type": "Watr"}}}})");
  const Value set = second.answer(4);
  EXPECT_EQ(set.find("result")->find("problem")->find("pointer")->asString(), "/nodes/x/type");
}

TEST_F(StudioTest, AfterAResetNothingAsksForOne) {
  const Socket writer = studio->socket(), viewer = studio->socket();
  writer.ask(R"({"id": 2, "do": "run.reset"})");
  Value set = parseJson(R"({"id": 3, "do": "scene.set"})", "message");
  set["scene"] = parseJson(kBriefScene, "scene");
  set["scene"]["world"]["duration"] = 1000;
  const Value changed = writer.ask(set);
  ASSERT_EQ(changed.find("result")->find("reset")->asString(), "world.duration");
  viewer.event("scene", [](const Value& data) { return data.find("reset") != nullptr; });
  const Value reset = writer.ask(R"({"id": 4, "do": "run.reset"})");
  EXPECT_EQ(reset.find("result")->find("reset"), nullptr);
  EXPECT_NE(reset.find("result")->find("revision"), nullptr);
  viewer.event("scene", [](const Value& data) { return data.find("reset") == nullptr; });
}

TEST_F(StudioTest, AnotherSceneThanTheEditedOneIsRunAndNotKept) {
  const Socket socket = studio->socket();
  const Value before = socket.ask(R"({"id": 1, "do": "hello"})");
  Value reset = parseJson(R"({"id": 2, "do": "run.reset"})", "message");
  reset["scene"] = parseJson(kBriefScene, "scene");
  reset["scene"]["nodes"]["water"]["params"]["spacing"] = 0.02;
  const Value answer = socket.ask(reset);
  EXPECT_EQ(answer.find("result")->find("reset")->asString(), "water.spacing");
  EXPECT_EQ(socket.state("paused").find("particles")->asInt(), 1000);
  const Value after = socket.ask(R"({"id": 3, "do": "hello"})");
  const auto sceneOf = [](const Value& hello) { return *hello.find("result")->find("scene")->find("scene"); };
  EXPECT_TRUE(sceneOf(after) == sceneOf(before));
  EXPECT_EQ(socket.ask(R"({"id": 4, "do": "run.reset"})").find("result")->find("reset"), nullptr);
  socket.event("status", [](const Value& s) {
    const Value* particles = s.find("particles");
    return particles != nullptr && particles->asInt() == 125;
  });
  for (const char* scene : {"7", R"({"weir": 1, "nodes": {"x": {"type": "Nothing"}}})"})
    EXPECT_NE(
        socket.ask(std::string(R"({"id": 5, "do": "run.reset", "scene": )") + scene + "}").find("error"),
        nullptr);
}

TEST_F(StudioTest, ADeviceThatCannotBeUsedIsRefusedAndTheLastOneStays) {
  const Socket socket = studio->socket();
  for (const char* device : {R"("cpw")", R"("")", R"("cuda:99999")", "7", "null"}) {
    const Value answer = socket.ask(std::string(R"({"id": 1, "do": "run.reset", "device": )") + device + "}");
    ASSERT_NE(answer.find("error"), nullptr) << device;
    EXPECT_FALSE(answer.find("error")->find("allowed")->asString().empty()) << device;
  }
  EXPECT_EQ(socket.ask(R"({"id": 2, "do": "hello"})").find("result")->find("device")->asString(), "cpu");
  EXPECT_EQ(socket.ask(R"({"id": 3, "do": "run.reset"})").find("result")->find("device")->asString(), "cpu");
  socket.sendText(R"({"id": 4, "do": "run.play"})");
  EXPECT_FALSE(socket.state("finished").isNull());
}

TEST_F(StudioTest, OutlivesMessagesWithoutSense) {
  const Socket socket(port, head("GET /api/live", bearer()));
  const std::string good = R"({"id": 7, "do": "scene.set", "scene": {"weir": 1, "nodes": {}, "links": []}})";
  std::mt19937 random(11);
  for (int i = 0; i < 2000; ++i) {
    std::string text = good;
    for (int changes = 1 + static_cast<int>(random() % 4); changes > 0; --changes)
      text[random() % text.size()] = static_cast<char>(' ' + random() % 95);
    text.resize(random() % (text.size() + 1));
    ASSERT_TRUE(socket.sendText(text)) << i;
  }
  for (const char* text :
       {"[]", "7", "\"\"", "{}", R"({"do": 5})", R"({"do": "run.seek", "frame": -1})",
        R"({"do": "view.set", "attribute": "speed", "most": 0})", R"({"do": "run.step", "frames": 1e9})",
        R"({"do": "scene.open", "path": "../../etc/passwd"})", R"({"do": "scene.save", "path": "x.txt"})"})
    ASSERT_TRUE(socket.sendText(text));
  ASSERT_TRUE(socket.sendText(R"({"id": 123456, "do": "hello"})"));
  EXPECT_NE(socket.answer(123456).find("result"), nullptr);
}

}  // namespace
}  // namespace weir::studio
