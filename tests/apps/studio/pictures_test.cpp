// Pictures and videos that the studio's server draws, with the plugin that draws them in runs.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <thread>

#include "framework/graph/plugin.h"
#include "framework/run/live_pictures.h"
#include "tests/apps/studio/web_client.h"
#include "tests/support/find_program.h"

namespace weir::studio {
namespace {

constexpr const char* kAsk =
    R"({"id": 1, "do": "picture", "eye": [1, 1, 1], "target": [0.1, 0.1, 0.1], "width": 64, "height": 48, "samples": 1})";

Value with(const std::string& text, const std::string& name, Value value) {
  Value request = parseJson(text, "request");
  request[name] = std::move(value);
  return request;
}

/// Sets a variable, and sets it back at the end. Only while no other thread runs.
class Environment {
 public:
  Environment(std::string name, const std::string& value) : name_(std::move(name)) {
    if (const char* before = std::getenv(name_.c_str())) before_ = before;
    ::setenv(name_.c_str(), value.c_str(), 1);
  }
  ~Environment() {
    if (before_)
      ::setenv(name_.c_str(), before_->c_str(), 1);
    else
      ::unsetenv(name_.c_str());
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  std::string name_;
  std::optional<std::string> before_;
};

class PicturesTest : public testing::Test {
 protected:
  void start(bool withPlugin, std::int64_t maxRecordedBytes = std::int64_t{1} << 30) {
    folder.write("scene.json", kBriefScene);
    StudioOptions options;
    options.maxRecordedBytes = maxRecordedBytes;
    options.folder = folder.path();
    options.threads = 1;
    studio = std::make_unique<RunningStudio>(options, "scene.json", [&](Registry& registry) {
      if (withPlugin)
        plugins.emplace_back(test::buildFolder() + "/lib/weir/plugins/weir_rendering.so", registry);
    });
  }

  test::TemporaryFolder folder;
  std::vector<Plugin> plugins;
  std::unique_ptr<RunningStudio> studio;
};

TEST_F(PicturesTest, WithoutAPluginThatIsSaid) {
  start(false);
  const Socket socket = studio->socket();
  const Value hello = socket.ask(R"({"id": 7, "do": "hello"})");
  EXPECT_NE(hello.find("result")->find("pictures")->find("problem"), nullptr);
  for (const char* text :
       {kAsk, R"({"id": 1, "do": "video.start", "path": "a.mp4", "eye": [1, 1, 1], "target": [0, 0, 0]})"}) {
    const Value answer = socket.ask(text);
    ASSERT_NE(answer.find("error"), nullptr) << text;
    EXPECT_NE(answer.find("error")->find("message")->asString().find("no plugin"), std::string::npos);
  }
}

/// Its pictures tell the nice value of the thread that draws.
class NiceValues final : public LivePictures, public LiveRenderer {
 public:
  std::vector<std::string> videoExtensions() const override { return {}; }
  std::unique_ptr<LiveRenderer> open(Simulation&) const override { return std::make_unique<NiceValues>(); }
  std::unique_ptr<Snapshot> capture(Simulation&, std::unique_ptr<Snapshot>) override {
    return std::make_unique<Snapshot>();
  }
  std::string draw(Snapshot&, const LivePictureOptions&) override {
    return std::to_string(::getpriority(PRIO_PROCESS, 0));
  }
  LivePixels pixels(Snapshot&, const LivePictureOptions&) override { return {}; }
  void startVideo(const std::filesystem::path&, int, int) override {}
  void addToVideo(Snapshot&, const LiveCamera&) override {}
  void finishVideo() override {}
};

TEST_F(PicturesTest, StepsGoBeforePictures) {
  const int ours = ::getpriority(PRIO_PROCESS, 0);
  if (ours > 10) GTEST_SKIP() << "the tests have such a low priority that there may be none below it";
  folder.write("scene.json", kBriefScene);
  StudioOptions options;
  options.folder = folder.path();
  options.threads = 1;
  const RunningStudio running(options, "scene.json", [](Registry& registry) {
    registry.addService<LivePictures>("nice values", [] { return std::make_unique<NiceValues>(); });
  });
  const Socket socket = running.socket();
  socket.ask(R"({"id": 5, "do": "run.reset"})");
  socket.sendText(kAsk);
  const auto packet = socket.until([](const Socket::Message& message) {
    return !message.text && Socket::headerOf(message).find("kind")->asString() == "picture";
  });
  ASSERT_TRUE(packet);
  const Value header = Socket::headerOf(*packet);
  const std::string nice(
      Socket::payloadOf(*packet).substr(static_cast<std::size_t>(header.find("data")->asInt()),
                                        static_cast<std::size_t>(header.find("bytes")->asInt())));
  EXPECT_GT(std::stoi(nice), ours);
  EXPECT_EQ(::getpriority(PRIO_PROCESS, 0), ours);
}

#ifdef WEIR_HAS_RENDERING

TEST_F(PicturesTest, BadRequestsAreRefused) {
  start(true);
  const Socket socket = studio->socket();
  const Value nowhere(Value::Array{Value(0.1), Value(0.1), Value(0.1)});
  for (const auto& [name, value] :
       std::vector<std::pair<std::string, Value>>{{"eye", nowhere},
                                                  {"eye", Value("left")},
                                                  {"eye", Value(Value::Array{Value(1), Value(2)})},
                                                  {"up", Value(Value::Array{Value(0), Value(0), Value(0)})},
                                                  {"fov", Value(180)},
                                                  {"width", Value(5000)},
                                                  {"height", Value(0)},
                                                  {"samples", Value(9)},
                                                  {"newer", Value(1)}})
    EXPECT_NE(socket.ask(with(kAsk, name, value)).find("error"), nullptr) << name;
  const std::string video =
      R"({"id": 1, "do": "video.start", "path": "a.mp4", "eye": [1, 1, 1], "target": [0, 0, 0]})";
  for (const char* path : {"a.txt", "../a.mp4", "/tmp/a.mp4", "none/a.mp4", "", "a\nb.mp4"})
    EXPECT_NE(socket.ask(with(video, "path", path)).find("error"), nullptr) << path;
  // Nothing has been simulated.
  const Value early = socket.ask(kAsk);
  ASSERT_NE(early.find("error"), nullptr);
  EXPECT_NE(early.find("error")->find("message")->asString().find("nothing to draw"), std::string::npos);
}

TEST_F(PicturesTest, ShowTheSceneFromAnySide) {
  start(true);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 5, "do": "run.reset"})");
  socket.sendText(kAsk);
  std::set<std::string> seen;
  for (int i = 0; i < 2; ++i) {
    const auto packet = socket.until([](const Socket::Message& message) {
      return !message.text && Socket::headerOf(message).find("kind")->asString() == "picture";
    });
    ASSERT_TRUE(packet);
    const Value header = Socket::headerOf(*packet);
    EXPECT_EQ(header.find("width")->asInt(), 64);
    const std::string_view jpeg =
        Socket::payloadOf(*packet).substr(static_cast<std::size_t>(header.find("data")->asInt()),
                                          static_cast<std::size_t>(header.find("bytes")->asInt()));
    EXPECT_TRUE(jpeg.starts_with("\xff\xd8\xff"));
    EXPECT_TRUE(jpeg.ends_with("\xff\xd9"));
    seen.emplace(jpeg);
    EXPECT_TRUE(socket.answer(1).find("result")->find("drawn")->asBool());
    socket.sendText(writeJsonLine(with(kAsk, "eye", Value(Value::Array{Value(-2), Value(0.1), Value(0)}))));
  }
  EXPECT_EQ(seen.size(), 2u);
}

TEST_F(PicturesTest, AFrameThatIsLookedBackAtLooksAsItDid) {
  start(true);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 5, "do": "run.reset"})");
  const auto picture = [&](const Value& request) {
    socket.sendText(writeJsonLine(request));
    const auto packet = socket.until([](const Socket::Message& message) {
      return !message.text && Socket::headerOf(message).find("kind")->asString() == "picture";
    });
    const Value answer = socket.answer(1);
    EXPECT_EQ(answer.find("result")->find("frame")->asInt(),
              Socket::headerOf(*packet).find("frame")->asInt());
    return std::pair(answer.find("result")->find("frame")->asInt(), std::string(Socket::payloadOf(*packet)));
  };
  const auto beginning = picture(parseJson(kAsk, "request"));
  socket.sendText(R"({"id": 6, "do": "run.play"})");
  socket.state("finished");
  const auto end = picture(parseJson(kAsk, "request"));
  EXPECT_NE(end.second, beginning.second);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(picture(with(kAsk, "frame", 0)), beginning);
    EXPECT_EQ(picture(with(kAsk, "frame", 4)), end);
  }
}

TEST_F(PicturesTest, TheNewestRequestWinsAndAllAreAnswered) {
  start(true);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 5, "do": "run.reset"})");
  constexpr int kRequests = 30;
  for (int i = 0; i < kRequests; ++i) socket.sendText(writeJsonLine(with(kAsk, "id", 100 + i)));
  int drawn = 0, answers = 0;
  bool lastDrawn = false;
  socket.until([&](const Socket::Message& message) {
    if (!message.text) return false;
    const Value value = parseJson(message.data, "answer");
    const Value* result = value.find("result");
    if (result == nullptr || result->find("drawn") == nullptr) return false;
    lastDrawn = result->find("drawn")->asBool();
    drawn += lastDrawn ? 1 : 0;
    return ++answers == kRequests;
  });
  EXPECT_EQ(answers, kRequests);
  EXPECT_GE(drawn, 1);
  EXPECT_TRUE(lastDrawn);
}

TEST_F(PicturesTest, NewerOnesWaitForAFrame) {
  start(true);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 5, "do": "run.reset"})");
  const Value first = socket.ask(kAsk);
  EXPECT_EQ(first.find("result")->find("frame")->asInt(), 0);
  socket.sendText(writeJsonLine(with(kAsk, "newer", true)));
  socket.sendText(R"({"id": 6, "do": "run.step", "frames": 2})");
  const Value second = socket.answer(1);
  EXPECT_GE(second.find("result")->find("frame")->asInt(), 1);
}

TEST_F(PicturesTest, WithoutOpenGLThatIsSaidAndTheRunGoesOn) {
  const Environment withoutGl("WEIR_GL", "nonsense");
  start(true);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 5, "do": "run.reset"})");
  const Value answer = socket.ask(kAsk);
  ASSERT_NE(answer.find("error"), nullptr);
  EXPECT_NE(answer.find("error")->find("message")->asString().find("WEIR_GL"), std::string::npos);
  socket.sendText(R"({"id": 6, "do": "run.play"})");
  EXPECT_FALSE(socket.state("finished").isNull());
  studio.reset();  // before the environment changes, which its threads read
}

TEST_F(PicturesTest, AWrongRenderSectionIsTheRequestsError) {
  start(true);
  const Socket socket = studio->socket();
  Value scene = parseJson(kBriefScene, "scene");
  scene["render"]["color"]["by"] = "beauty";
  Value set = parseJson(R"({"id": 4, "do": "scene.set"})", "request");
  set["scene"] = scene;
  socket.ask(set);
  socket.ask(R"({"id": 5, "do": "run.reset"})");
  for (int i = 0; i < 2; ++i) {
    const Value answer = socket.ask(kAsk);
    ASSERT_NE(answer.find("error"), nullptr);
    EXPECT_NE(answer.find("error")->find("message")->asString().find("beauty"), std::string::npos);
  }
  socket.sendText(R"({"id": 6, "do": "run.play"})");
  EXPECT_FALSE(socket.state("finished").isNull());
}

bool hasEnded(const Value& video) {
  const std::string& state = video.find("state")->asString();
  return state == "done" || state == "failed";
}

/// The end of a video that is being stopped. It may have failed before, which was told then, and is told
/// here.
Value endOf(const Socket& socket, const Value& stopped) {
  const Value* result = stopped.find("result");
  if (result == nullptr) throw std::runtime_error("no result: " + writeJsonLine(stopped));
  return hasEnded(*result) ? *result : socket.event("video", hasEnded);
}

TEST_F(PicturesTest, AVideoHasAPictureOfEachFrame) {
  if (test::findProgram("ffmpeg").empty()) GTEST_SKIP() << "ffmpeg is not on the PATH";
  start(true);
  const Socket socket = studio->socket();
  const std::string begin =
      R"({"id": 2, "do": "video.start", "path": "run.mp4", "eye": [1, 1, 1], "target": [0, 0, 0], "width": 64, "height": 48})";
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  const Value started = socket.ask(begin);
  ASSERT_NE(started.find("result"), nullptr) << writeJsonLine(started);
  EXPECT_EQ(started.find("result")->find("state")->asString(), "recording");
  EXPECT_NE(socket.ask(begin).find("error"), nullptr);  // one at a time
  socket.ask(R"({"id": 3, "do": "video.camera", "eye": [1, 2, 1], "target": [0, 0, 0]})");
  socket.sendText(R"({"id": 4, "do": "run.play"})");
  const Value done = socket.event("video", hasEnded);
  EXPECT_EQ(done.find("state")->asString(), "done") << writeJsonLine(done);
  EXPECT_EQ(done.find("frames")->asInt(), 5);  // 0 to 4
  const std::string video = test::readFile(folder / "run.mp4");
  EXPECT_GT(video.size(), 500u);
  // It carries the scene in a box at its end, which tells its own size.
  const std::size_t id = video.find("uuidweir-scene-json1");
  ASSERT_NE(id, std::string::npos);
  std::size_t size = 0;
  for (std::size_t i = id - 4; i < id; ++i) size = size << 8 | static_cast<unsigned char>(video[i]);
  EXPECT_EQ(id - 4 + size, video.size());
  const Value scene = parseJson(video.substr(id + 20), "the scene in the video");
  EXPECT_TRUE(scene ==
              *socket.ask(R"({"id": 9, "do": "hello"})").find("result")->find("scene")->find("scene"));
}

/// The brief scene to its end, a frame at a time, so that there is time to keep the states between them.
/// Gives back the last status.
Value stepToTheEnd(const Socket& socket) {
  constexpr int kFrames = 4;
  Value last;
  for (int frame = 1; frame <= kFrames; ++frame) {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    socket.sendText(R"({"do": "run.step"})");
    last = socket.event("status", [&](const Value& status) {
      const Value* at = status.find("frame");
      return at != nullptr && *at == Value(frame) && status.find("state")->asString() != "playing";
    });
  }
  return last;
}

/// Its pictures as they are in the file, without the scene at its end.
std::string picturesIn(const std::string& video) {
  return video.substr(0, video.find("uuidweir-scene-json1") - 4);
}

constexpr const char* kRecorded =
    R"({"id": 2, "do": "video.start", "recorded": true, "path": "b.mp4", "eye": [1, 1, 1], "target": [0, 0, 0], "width": 64, "height": 48})";

TEST_F(PicturesTest, AVideoOfARunThatHasEndedIsOfItsRecordedFrames) {
  if (test::findProgram("ffmpeg").empty()) GTEST_SKIP() << "ffmpeg is not on the PATH";
  start(true);
  const Socket socket = studio->socket();
  EXPECT_NE(socket.ask(kRecorded).find("error"), nullptr);  // there is no run
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  socket.state("paused");
  Value live = with(kRecorded, "recorded", false);
  live["path"] = "a.mp4";
  ASSERT_NE(socket.ask(live).find("result"), nullptr);
  const Value before = stepToTheEnd(socket);
  EXPECT_EQ(before.find("state")->asString(), "finished");
  while (!hasEnded(*socket.ask(R"({"id": 9, "do": "hello"})").find("result")->find("video")))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));

  const Value started = socket.ask(kRecorded);
  ASSERT_NE(started.find("result"), nullptr) << writeJsonLine(started);
  EXPECT_EQ(started.find("result")->find("of")->asInt(), 5);
  const Value done = socket.event("video", hasEnded);
  EXPECT_EQ(done.find("state")->asString(), "done") << writeJsonLine(done);
  EXPECT_EQ(done.find("frames")->asInt(), 5);
  const std::int64_t whole = done.find("whole")->asInt();
  EXPECT_EQ(whole, before.find("whole")->asInt());
  // Where each was kept, it is the video that was made while they came.
  if (whole == 5) {
    EXPECT_EQ(picturesIn(test::readFile(folder / "b.mp4")), picturesIn(test::readFile(folder / "a.mp4")));
  }
  // Not a step was made for it.
  const Value after = *socket.ask(R"({"id": 9, "do": "hello"})").find("result")->find("status");
  EXPECT_EQ(after.find("state")->asString(), "finished");
  EXPECT_EQ(after.find("steps")->asInt(), before.find("steps")->asInt());
}

TEST_F(PicturesTest, AVideoTellsHowManyFramesWereKept) {
  if (test::findProgram("ffmpeg").empty()) GTEST_SKIP() << "ffmpeg is not on the PATH";
  constexpr std::int64_t kRoomForFew = 50'000;  // half of it for states, of 125 particles each
  start(true, kRoomForFew);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  socket.state("paused");
  const std::int64_t whole = stepToTheEnd(socket).find("whole")->asInt();
  EXPECT_GE(whole, 2);
  EXPECT_LT(whole, 5);
  ASSERT_NE(socket.ask(kRecorded).find("result"), nullptr);
  const Value done = socket.event("video", hasEnded);
  EXPECT_EQ(done.find("state")->asString(), "done") << writeJsonLine(done);
  EXPECT_EQ(done.find("frames")->asInt(), 5);  // at the run's own pace
  EXPECT_EQ(done.find("of")->asInt(), 5);
  EXPECT_EQ(done.find("whole")->asInt(), whole);
}

TEST_F(PicturesTest, WhereNoFrameWasKeptThereIsNoVideoOfThem) {
  start(true, 2000);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  socket.state("paused");
  stepToTheEnd(socket);
  const Value refused = socket.ask(kRecorded);
  ASSERT_NE(refused.find("error"), nullptr);
  EXPECT_NE(refused.find("error")->find("message")->asString().find("kept whole"), std::string::npos);
}

TEST_F(PicturesTest, AResetCompletesAVideoOfRecordedFrames) {
  if (test::findProgram("ffmpeg").empty()) GTEST_SKIP() << "ffmpeg is not on the PATH";
  start(true);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  socket.state("paused");
  stepToTheEnd(socket);
  socket.sendText(kRecorded);
  socket.sendText(R"({"id": 3, "do": "run.reset"})");
  const Value done = socket.event("video", hasEnded);
  EXPECT_EQ(done.find("state")->asString(), "done") << writeJsonLine(done);
  EXPECT_LE(done.find("frames")->asInt(), 5);
}

TEST_F(PicturesTest, AVideoThatIsStoppedIsComplete) {
  if (test::findProgram("ffmpeg").empty()) GTEST_SKIP() << "ffmpeg is not on the PATH";
  start(true);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  socket.ask(
      R"({"id": 2, "do": "video.start", "path": "a.mp4", "eye": [1, 1, 1], "target": [0, 0, 0], "width": 64, "height": 48})");
  socket.ask(R"({"id": 3, "do": "run.step", "frames": 1})");
  socket.event("status", [](const Value& data) {
    const Value* frame = data.find("frame");
    return frame != nullptr && *frame == Value(1) && data.find("state")->asString() == "paused";
  });
  const Value done = endOf(socket, socket.ask(R"({"id": 4, "do": "video.stop"})"));
  EXPECT_EQ(done.find("state")->asString(), "done") << writeJsonLine(done);
  EXPECT_TRUE(std::filesystem::exists(folder / "a.mp4"));
}

TEST_F(PicturesTest, WithoutFfmpegTheVideoFailsAndTheRunGoesOn) {
  const Environment withoutPrograms("PATH", folder.path());
  start(true);
  const Socket socket = studio->socket();
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  const char* const begin =
      R"({"id": 2, "do": "video.start", "path": "a.mp4", "eye": [1, 1, 1], "target": [0, 0, 0]})";
  socket.ask(begin);
  const auto tellsFfmpeg = [](const Value& video) {
    return video.find("state")->asString() == "failed" &&
           video.find("problem")->find("message")->asString().find("ffmpeg") != std::string::npos;
  };
  const Value failed = socket.event("video", hasEnded);
  EXPECT_TRUE(tellsFfmpeg(failed)) << writeJsonLine(failed);
  EXPECT_TRUE(socket.ask(kAsk).find("result")->find("drawn")->asBool());
  // One that is stopped later, and who comes later, are told the same.
  socket.ask(begin);
  socket.ask(R"({"id": 3, "do": "run.step", "frames": 1})");
  socket.event("status", [](const Value& data) { return *data.find("frame") == Value(1); });
  const Value stopped = endOf(socket, socket.ask(R"({"id": 4, "do": "video.stop"})"));
  EXPECT_TRUE(tellsFfmpeg(stopped)) << writeJsonLine(stopped);
  const Socket other = studio->socket();
  const Value hello = other.ask(R"({"id": 5, "do": "hello"})");
  EXPECT_TRUE(tellsFfmpeg(*hello.find("result")->find("video"))) << writeJsonLine(hello);
  socket.sendText(R"({"id": 6, "do": "run.play"})");
  EXPECT_FALSE(socket.state("finished").isNull());
  EXPECT_FALSE(std::filesystem::exists(folder / "a.mp4"));
  studio.reset();
}

#endif

}  // namespace
}  // namespace weir::studio
