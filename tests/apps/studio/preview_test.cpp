// A preview runs the scene coarser, and leaves the scene as it is.
#include "apps/studio/session/preview.h"

#include <gtest/gtest.h>

#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

Value edited(const Socket& socket, const std::function<void(Value&)>& change) {
  Value set = parseJson(R"({"id": 10, "do": "scene.set"})", "request");
  set["scene"] = parseJson(kBriefScene, "scene");
  change(set["scene"]);
  return *socket.ask(set).find("result");
}

TEST(Preview, HasFewerParticlesOfTheSameSceneAndIsNotExported) {
  const test::TemporaryFolder folder;
  folder.write("scene.json", kBriefScene);
  StudioOptions options;
  options.folder = folder.path();
  options.threads = 1;
  const RunningStudio studio(options, "scene.json");
  const Socket socket = studio.socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  const Value full = socket.state("paused");
  EXPECT_EQ(full.find("coarser")->asInt(), 1);
  const std::int64_t all = full.find("particles")->asInt();

  const Value reset = *socket.ask(R"({"id": 2, "do": "run.reset", "coarser": 2})").find("result");
  EXPECT_FALSE(reset.find("changed")->asBool());
  EXPECT_EQ(reset.find("reset"), nullptr);
  const Value preview = socket.event("status", [](const Value& status) {
    return status.find("coarser")->asInt() == 2 && status.find("state")->asString() == "paused";
  });
  // An eighth of them; more, as 0.2 m are no whole number of such spacings.
  const std::int64_t few = preview.find("particles")->asInt();
  EXPECT_GE(few, all / 8 - 10);
  EXPECT_LE(few, all / 4);
  EXPECT_EQ(*socket.ask(R"({"id": 3, "do": "hello"})").find("result")->find("scene")->find("scene"),
            parseJson(kBriefScene, "scene"));
  const Value cost = *socket.ask(R"({"id": 4, "do": "scene.cost"})").find("result");
  EXPECT_LE(cost.find("particles")->asDouble(), static_cast<double>(all) / 2);

  // What may change during a run may do so in a preview; the scene's own spacing may not.
  const auto lighter = [](Value& scene) { scene["world"]["gravity"] = Value(Value::Array{0, -1, 0}); };
  EXPECT_EQ(edited(socket, lighter).find("reset"), nullptr);
  const auto finer = [](Value& scene) { scene["nodes"]["water"]["params"]["spacing"] = 0.03; };
  EXPECT_EQ(edited(socket, finer).find("reset")->asString(), "water.spacing");

  const Value refused =
      socket.ask(R"({"id": 5, "do": "video.start", "path": "a.mp4", "eye": [1, 1, 1], "target": [0, 0, 0]})");
  EXPECT_EQ(refused.find("error")->find("message")->asString(), "a preview is not written as a video");
  const Value wrong = socket.ask(R"({"id": 6, "do": "run.reset", "coarser": 0})");
  EXPECT_EQ(wrong.find("error")->find("message")->asString(), "'coarser' is 0");

  socket.ask(R"({"id": 7, "do": "scene.set", "scene": )" + std::string(kBriefScene) + "}");
  socket.ask(R"({"id": 8, "do": "run.reset", "coarser": 1})");
  const Value again = socket.event("status", [](const Value& status) {
    return status.find("coarser")->asInt() == 1 && status.find("state")->asString() == "paused";
  });
  EXPECT_EQ(again.find("particles")->asInt(), all);
}

}  // namespace
}  // namespace weir::studio
