#include "apps/studio/session/scene_check.h"

#include <gtest/gtest.h>

#include "nodes/register_nodes.h"

namespace weir::studio {
namespace {

constexpr const char* kScene = R"({
  "weir": 1, "world": { "duration": 0.1 },
  "nodes": { "block": { "type": "BoxSampler" },
             "water": { "type": "ParticleFluid", "modules": { "viscosity": { "params": { "rate": 100 } } } } },
  "links": ["block.particles -> water.initial"]
})";

class SceneCheck : public testing::Test {
 protected:
  SceneCheck() { registerNodes(registry); }

  CheckedScene check(const std::string& from, const std::string& to) const {
    std::string text = kScene;
    if (!from.empty()) text.replace(text.find(from), from.size(), to);
    return checkScene(parseJson(text, "test"), "scene.json", "", registry);
  }
  SceneDifference difference(const std::string& from, const std::string& to) const {
    return differenceOf(*check("", "").scene, *check(from, to).scene);
  }

  Registry registry;
};

TEST_F(SceneCheck, ASceneFileIsEditedInPlainForm) {
  const auto read = [&](const std::string& text) { return readSceneFile(text, "scene.json", "", registry); };
  const std::string nodes = R"("nodes": {"block": {"type": "BoxSampler", "note": "n"}}})";
  const OpenedScene plain = read("{\"weir\": 1, \"world\": {\"duration\": 2}, " + nodes);
  EXPECT_EQ(plain.warning, "");
  EXPECT_NE(plain.scene.find("nodes")->find("block")->find("note"), nullptr);
  const OpenedScene commented = read("{\"weir\": 1, // two\n \"world\": {\"duration\": 2}, " + nodes);
  EXPECT_EQ(commented.scene, plain.scene);
  EXPECT_NE(commented.warning.find("has comments"), std::string::npos);
  for (const char* duration : {"\"=2*n\"", "\"2 s\"", "2"}) {
    const OpenedScene shorthand =
        read("{\"weir\": 1, \"let\": {\"n\": 1}, \"world\": {\"duration\": " + std::string(duration) + "}, " +
             nodes);
    EXPECT_EQ(*shorthand.scene.find("world")->find("duration"), Value(2));
    EXPECT_EQ(shorthand.scene.find("let"), nullptr);
    EXPECT_NE(shorthand.warning.find("has variables"), std::string::npos);
  }
  const OpenedScene broken = read("{\"weir\": 1, \"world\": {\"duration\": \"=x\"}, " + nodes);
  EXPECT_EQ(*broken.scene.find("world")->find("duration"), Value("=x"));
}

TEST_F(SceneCheck, TellsWhereAProblemIs) {
  const CheckedScene wrong = check("\"rate\": 100", "\"rate\": \"much\"");
  EXPECT_EQ(wrong.scene, nullptr);
  ASSERT_TRUE(wrong.problem);
  EXPECT_EQ(wrong.problem->find("pointer")->asString(), "/nodes/water/modules/viscosity/params/rate");
  EXPECT_FALSE(wrong.problem->find("message")->asString().empty());
  EXPECT_TRUE(check("", "").scene);
}

TEST_F(SceneCheck, KnowsWhatMayChangeDuringARun) {
  EXPECT_TRUE(difference("", "").live.empty());
  EXPECT_FALSE(difference("", "").reset);
  const SceneDifference live = difference("\"rate\": 100", "\"rate\": 200");
  ASSERT_EQ(live.live.size(), 1u);
  EXPECT_FALSE(live.reset);
  EXPECT_EQ(live.live[0].module, "viscosity");
  const CheckedScene running = check("", "");
  apply(live.live[0], *running.scene);
  EXPECT_FALSE(differenceOf(*running.scene, *check("\"rate\": 100", "\"rate\": 200").scene).reset);
  EXPECT_TRUE(differenceOf(*running.scene, *check("\"rate\": 100", "\"rate\": 200").scene).live.empty());
}

TEST_F(SceneCheck, NamesWhatAsksForAReset) {
  EXPECT_EQ(*difference("\"duration\": 0.1", "\"duration\": 0.2").reset, "world.duration");
  EXPECT_EQ(*difference("\"ParticleFluid\"", "\"ParticleFluid\", \"params\": { \"spacing\": 0.03 }").reset,
            "water.spacing");
  EXPECT_EQ(*difference("\"links\": [\"block.particles -> water.initial\"]", "\"links\": []").reset,
            "the links");
  EXPECT_EQ(*difference("\"rate\": 100 }", "\"rate\": 100 }, \"enabled\": false").reset,
            "the modules of water");
}

}  // namespace
}  // namespace weir::studio
