// A body that is pulled follows the hand, as the closed form says, and falls when it is let go.
#include "apps/studio/session/body_pull.h"

#include <gtest/gtest.h>

#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

// A body that falls freely from 0.5 m.
constexpr const char* kScene = R"({
  "weir": 1, "world": { "duration": 4, "frame_rate": 10, "dt": 0.002 },
  "nodes": { "cube": { "type": "BoxMesh", "params": { "min": [-0.1, -0.1, -0.1], "max": [0.1, 0.1, 0.1] } },
             "body": { "type": "RigidBody", "params": { "density": 500, "position": [0, 0.5, 0] } } },
  "links": ["cube.surface -> body.mesh"]
})";

class BodyPullTest : public testing::Test {
 protected:
  void start(const std::string& scene = kScene) {
    folder.write("scene.json", scene);
    StudioOptions options;
    options.folder = folder.path();
    options.threads = 1;
    studio = std::make_unique<RunningStudio>(options, "scene.json");
    socket = std::make_unique<Socket>(studio->port(), studio->head("GET /api/live", studio->bearer()));
    socket->ask(R"({"id": 1, "do": "run.reset"})");
    socket->state("paused");
  }
  /// The height of the body after some frames more, m, and its speed upwards, m/s.
  std::pair<double, double> after(std::int64_t frames) {
    frame += frames;
    socket->sendText(R"({"id": 2, "do": "run.step", "frames": )" + std::to_string(frames) + "}");
    const Value numbers =
        socket->event("numbers", [&](const Value& told) { return told.find("frames")->asInt() == frame; });
    const Value& body = *numbers.find("nodes")->find("body");
    return {body.find("position")->asArray()[1].asDouble(), body.find("velocity")->asArray()[1].asDouble()};
  }
  std::string refusal(const char* request) const {
    const Value answer = socket->ask(request);
    return answer.find("error") != nullptr ? answer.find("error")->find("message")->asString() : "";
  }

  test::TemporaryFolder folder;
  std::unique_ptr<RunningStudio> studio;
  std::unique_ptr<Socket> socket;
  std::int64_t frame = 0;
};

constexpr double kGravity = 9.8, kRate = 30;

TEST_F(BodyPullTest, ABodyThatIsPulledUpMovesUpAndHangsFromTheSpring) {
  start();
  EXPECT_EQ(refusal(R"({"id": 3, "do": "body.pull", "node": "body", "to": [0, 1.5, 0]})"), "");
  const auto [height, speed] = after(3);
  EXPECT_GT(height, 0.6);
  EXPECT_GT(speed, 0);
  const auto [rest, still] = after(12);
  EXPECT_NEAR(rest, 1.5 - kGravity / (kRate * kRate), 1e-4);
  EXPECT_NEAR(still, 0, 1e-4);
  // Let go, it falls freely: by g·t²/2 in half a second, but for what the steps come to.
  EXPECT_EQ(refusal(R"({"id": 4, "do": "body.release"})"), "");
  const auto [fallen, down] = after(5);
  EXPECT_NEAR(rest - fallen, kGravity * 0.5 * 0.5 / 2, 0.01);
  EXPECT_NEAR(down, -kGravity * 0.5, 0.01);
}

TEST_F(BodyPullTest, ItHangsStillAlsoWhereStepsAreLong) {
  const double dt = 0.05;
  std::string scene = kScene;
  scene.replace(scene.find("0.002"), 5, "0.05");
  start(scene);
  EXPECT_EQ(refusal(R"({"id": 3, "do": "body.pull", "node": "body", "to": [0, 1.5, 0]})"), "");
  const auto [rest, still] = after(30);
  EXPECT_NEAR(rest, 1.5 - kGravity * 4 * dt * dt, 1e-3);
  EXPECT_NEAR(still, 0, 1e-3);
}

TEST_F(BodyPullTest, WhoLeavesLetsGo) {
  start();
  socket->ask(R"({"id": 3, "do": "body.pull", "node": "body", "to": [0, 0.5, 0]})");
  after(10);
  const Socket other = studio->socket();
  other.ask(R"({"id": 1, "do": "role.claim"})");
  EXPECT_EQ(refusal(R"({"id": 4, "do": "body.pull", "node": "body", "to": [0, 0.5, 0]})"),
            "another window has the pen");
  socket->ask(R"({"id": 5, "do": "role.claim"})");
  EXPECT_LT(after(5).second, -0.9 * kGravity * 0.5);
}

TEST_F(BodyPullTest, WhatCannotBePulledIsToldApart) {
  std::string scene = kScene;
  scene.replace(scene.find("\"density\""), 0,
                R"("applied_force": {"keyframes": [[0, [0, 0, 0]], [1, [0, 1, 0]]]}, )");
  start(scene);
  EXPECT_NE(refusal(R"({"id": 3, "do": "body.pull", "node": "body", "to": [0, 1, 0]})").find("keyframes"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"id": 4, "do": "body.pull", "node": "cube", "to": [0, 1, 0]})").find("not a body"),
            std::string::npos);
  EXPECT_EQ(refusal(R"({"id": 5, "do": "body.pull", "node": "body", "to": [0, 1]})"), "'to' is [0, 1]");
}

}  // namespace
}  // namespace weir::studio
