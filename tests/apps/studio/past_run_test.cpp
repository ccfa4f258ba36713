// Frames that are looked back at are what the run was at them, and the run does not notice.
#include "apps/studio/session/past_run.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/apps/studio/web_client.h"

namespace weir::studio {
namespace {

class PastRunTest : public testing::Test {
 protected:
  void start(std::int64_t maxRecordedBytes) {
    folder.write("scene.json", kBriefScene);
    StudioOptions options;
    options.folder = folder.path();
    options.threads = 1;
    options.maxRecordedBytes = maxRecordedBytes;
    studio = std::make_unique<RunningStudio>(options, "scene.json");
    socket = std::make_unique<Socket>(studio->port(), studio->head("GET /api/live", studio->bearer()));
    socket->ask(R"({"id": 1, "do": "run.reset"})");
    socket->state("paused");
  }
  Value ask(const std::string& more) const {
    return socket->ask(R"({"id": 3, "do": "particles", "node": "water", "count": 200)" + more + "}");
  }
  /// As a frame of the run shows them.
  Value table(const std::string& more = "") const {
    const Value answer = ask(more);
    const Value* result = answer.find("result");
    return result != nullptr ? *result : Value();
  }
  static std::int64_t frameOf(const Value& table) { return table.find("frame")->asInt(); }

  test::TemporaryFolder folder;
  std::unique_ptr<RunningStudio> studio;
  std::unique_ptr<Socket> socket;
};

TEST_F(PastRunTest, AFrameThatIsLookedBackAtIsWhatTheRunWasAtIt) {
  start(1 << 30);
  constexpr std::int64_t kFrames = 4;
  std::map<std::int64_t, std::string> was{{0, writeJsonLine(table())}};
  for (std::int64_t frame = 1; frame <= kFrames; ++frame) {
    socket->ask(R"({"id": 2, "do": "run.step"})");
    socket->event("status", [&](const Value& status) {
      return status.find("state")->asString() != "playing" && status.find("frame")->asInt() == frame;
    });
    was[frame] = writeJsonLine(table());
  }
  // There and back: each is that frame's, or the nearest one's that is kept.
  for (const std::int64_t frame : {0, 2, 4}) {
    const Value then = table(R"(, "frame": )" + std::to_string(frame));
    ASSERT_FALSE(then.isNull()) << frame;
    EXPECT_EQ(writeJsonLine(then), was[frameOf(then)]) << frame;
    if (frame == 0 || frame == kFrames) {
      EXPECT_EQ(frameOf(then), frame);
    }
  }
  EXPECT_NE(was[0], was[kFrames]);
  EXPECT_EQ(writeJsonLine(table()), was[kFrames]);  // the run itself
  // What comes next has its own past.
  socket->ask(R"({"id": 2, "do": "run.reset"})");
  socket->state("paused");
  EXPECT_EQ(writeJsonLine(table(R"(, "frame": 4)")), was[0]);
}

TEST_F(PastRunTest, WhereNoFrameIsKeptWholeThatIsSaid) {
  start(2000);
  socket->ask(R"({"id": 2, "do": "run.step"})");
  socket->event("status", [](const Value& status) { return *status.find("frame") == Value(1); });
  const Value refused = ask(R"(, "frame": 0)");
  ASSERT_NE(refused.find("error"), nullptr) << writeJsonLine(refused);
  EXPECT_NE(refused.find("error")->find("message")->asString().find("no frame of this run is kept whole"),
            std::string::npos);
  EXPECT_EQ(frameOf(table()), 1);  // the run has not failed
}

}  // namespace
}  // namespace weir::studio
