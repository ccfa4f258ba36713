// What the studio's server must survive: nonsense, strangers, paths that lead elsewhere, clients that do not
// read, and simulations that fail.
//
// WEIR_TEST_MESSAGES=100000 sends as many damaged messages; else there are a few thousand.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "framework/base/sanitizers.h"
#include "framework/base/text.h"
#include "framework/graph/plugin.h"
#include "tests/apps/studio/web_client.h"
#include "tests/support/byte_mutator.h"

#ifdef WEIR_ADDRESS_SANITIZER
// Of the sanitizer's runtime; g++ comes without the header.
extern "C" std::size_t __sanitizer_get_current_allocated_bytes();
#endif

namespace weir::studio {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene = R"({
  "weir": 1, "world": { "duration": 1, "frame_rate": 100 },
  "nodes": { "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.2, 0.2] } },
             "water": { "type": "ParticleFluid", "params": { "spacing": 0.04, "rest_steps": 0 } } },
  "links": ["block.particles -> water.initial"]
})";

class BadInputTest : public testing::Test {
 protected:
  BadInputTest() {
    fs::create_directory(outside / "secret");
    outside.write("secret.txt", "a secret");
    folder.write("scene.json", kScene);
    options.folder = folder.path();
    options.page = folder / "page";
    options.templates = folder / "templates";
    options.types = "{}";
    options.threads = 1;
    options.largestUpload = 1 << 20;
    options.maxWaitingBytes = 1 << 20;
  }
  void start() {
    studio = std::make_unique<RunningStudio>(options, "scene.json", [this](Registry& registry) {
      plugins.emplace_back(test::buildFolder() + "/lib/weir/test_plugins/failing_hooks.so", registry);
    });
  }
  int get(const std::string& path) const {
    return studio->status(studio->head("GET " + path, studio->bearer()) + "\r\n");
  }
  int put(const std::string& path) const {
    return studio->status(studio->head("PUT " + path, studio->bearer() + "Content-Length: 2\r\n") + "\r\nxx");
  }
  /// Edits the scene; `change` gets it as it is in kScene.
  static void edit(const Socket& socket, const std::function<void(Value&)>& change) {
    Value scene = parseJson(kScene, "scene");
    change(scene);
    Value set = parseJson(R"({"id": 40, "do": "scene.set"})", "request");
    set["scene"] = std::move(scene);
    const Value answer = socket.ask(set);
    ASSERT_NE(answer.find("result"), nullptr);
    EXPECT_EQ(answer.find("result")->find("problem"), nullptr) << writeJsonLine(answer);
  }
  /// Whether the good scene can be run.
  static testing::AssertionResult runsOn(const Socket& socket) {
    edit(socket, [](Value& scene) { scene["world"]["duration"] = 0.02; });
    const Value reset = socket.ask(R"({"id": 41, "do": "run.reset"})");
    if (reset.find("result") == nullptr) return testing::AssertionFailure() << writeJsonLine(reset);
    socket.sendText(R"({"id": 42, "do": "run.play"})");
    try {
      socket.state("finished");
    } catch (const std::exception& e) {
      return testing::AssertionFailure() << e.what();
    }
    return testing::AssertionSuccess();
  }

  test::TemporaryFolder folder, outside;
  StudioOptions options;
  std::vector<Plugin> plugins;
  std::unique_ptr<RunningStudio> studio;
};

std::int64_t messageCount() {
  const char* wanted = std::getenv("WEIR_TEST_MESSAGES");
  return wanted != nullptr ? std::atoll(wanted) : 3000;
}

TEST_F(BadInputTest, DamagedMessages) {
  start();
  const std::vector<std::string> good{
      R"({"id": 7, "do": "scene.set", "scene": {"weir": 1, "nodes": {}, "links": []}})",
      R"({"id": 7, "do": "scene.set", "scene": )" + std::string(kScene) + "}",
      R"({"id": 7, "do": "scene.open", "path": "scene.json"})",
      R"({"id": 7, "do": "scene.open", "template": "a.json"})",
      R"({"id": 7, "do": "scene.save", "path": "saved.json"})",
      R"({"id": 7, "do": "run.reset", "device": "cpu"})",
      R"({"id": 7, "do": "run.play"})",
      R"({"id": 7, "do": "run.pause"})",
      R"({"id": 7, "do": "run.step", "frames": 2})",
      R"({"id": 7, "do": "run.seek", "frame": 1})",
      R"({"id": 7, "do": "view.set", "attribute": "speed", "most": 50})",
      R"({"id": 7, "do": "stream.set", "particles": true})",
      R"({"id": 7, "do": "particle", "node": "water", "particle": 3})",
      R"({"id": 7, "do": "particles", "node": "water", "sort": "speed", "descending": true, "from": 9, "count": 3})",
      R"({"id": 7, "do": "scene.new"})",
      R"({"id": 7, "do": "draft.drop"})",
      R"({"id": 7, "do": "picture", "eye": [1, 1, 1], "target": [0, 0, 0], "width": 64, "newer": false})",
      R"({"id": 7, "do": "video.start", "path": "a.mp4", "eye": [1, 1, 1], "target": [0, 0, 0]})",
      R"({"id": 7, "do": "video.camera", "eye": [1, 1, 1], "target": [0, 0, 0]})",
      R"({"id": 7, "do": "video.stop"})",
      R"({"id": 7, "do": "scene.set", "scene": {"weir": 1, "title": "ü€𝄞", "nodes": {}, "links": []}})",
      R"({"id": 7, "do": "role.claim"})",
      R"({"do": "frame.seen"})"};
  const auto connect = [this] {
    return std::make_unique<Socket>(studio->port(), studio->head("GET /api/live", studio->bearer()));
  };
  auto socket = connect();
  const std::int64_t count = messageCount();
  constexpr std::int64_t kRound = 50;
  bool allText = true;  // since the last round
  for (std::int64_t i = 0; i < count; ++i) {
    const std::string text =
        test::damaged(good[static_cast<std::size_t>(i) % good.size()], static_cast<std::uint64_t>(i));
    allText = allText && isUtf8(text);
    const bool sent = socket->sendText(text);
    ASSERT_TRUE(sent || !allText) << i;
    if (i % kRound != 0) continue;
    // Messages that are no UTF-8 end their connection, as RFC 6455 wants it; all others are answered.
    const bool answered = sent && socket->ask(R"({"id": 123456, "do": "hello"})").find("result") != nullptr;
    ASSERT_TRUE(answered || !allText) << i;
    if (!answered) {
      socket = connect();
      ASSERT_NE(socket->ask(R"({"id": 123456, "do": "hello"})").find("result"), nullptr) << i;
    }
    allText = true;
  }
  // Damaged frames end their connection, and no other.
  for (std::int64_t i = 0; i < count / 20; ++i) {
    const Socket other = studio->socket();
    ASSERT_TRUE(other.accepted()) << i;
    const auto seed = static_cast<std::uint64_t>(i);
    other.sendRaw(test::damaged(Socket::frameOf(good[seed % good.size()]), seed));
  }
  socket = connect();
  socket->ask(R"({"id": 8, "do": "role.claim"})");
  EXPECT_TRUE(runsOn(*socket));
}

TEST_F(BadInputTest, DeepAndLargeMessages) {
  start();
  const Socket socket = studio->socket();
  constexpr std::size_t kDeep = 200'000;
  ASSERT_TRUE(socket.sendText(R"({"id": 1, "do": )" + std::string(kDeep, '[')));
  ASSERT_TRUE(socket.sendText(std::string(kDeep, '{')));
  ASSERT_TRUE(socket.sendText("\xff\xfe" + std::string(1000, '\0')) || true);
  const Socket other = studio->socket();
  EXPECT_NE(other.ask(R"({"id": 2, "do": "hello"})").find("result"), nullptr);
}

TEST_F(BadInputTest, StrangersGetNothing) {
  start();
  const std::string& token = studio->token();
  const std::string port = std::to_string(studio->port());
  const auto types = [&](const std::string& more) {
    return studio->status(studio->head("GET /api/types", more) + "\r\n");
  };
  EXPECT_EQ(types("Authorization: Bearer " + token + "\r\n"), 200);
  const std::string cookie = "Cookie: a=b; " + std::string(AccessRules::kCookie) + "=";
  EXPECT_EQ(types(cookie + token + "\r\n"), 200);
  for (const std::string& wrong : {std::string(), token.substr(1), token + "0", token.substr(0, 31) + "g",
                                   std::string(32, '~'), std::string("*"), token + " " + token})
    for (const char* kind : {"Authorization: Bearer ", "Authorization: Basic ",
                             "Authorization: ", "Cookie: weir_studio=", "Cookie: token="})
      EXPECT_EQ(types(kind + wrong + "\r\n"), 401) << kind << wrong;
  for (const std::string& origin :
       {std::string("null"), std::string("http://evil.example"), "https://127.0.0.1:" + port,
        "http://127.0.0.1:" + port + ".evil.example", "http://127.0.0.1:1" + port,
        std::string("http://127.0.0.1"), "http://evil.example@127.0.0.1:" + port, std::string("file://")}) {
    EXPECT_EQ(types(studio->bearer() + "Origin: " + origin + "\r\n"), 403) << origin;
    EXPECT_FALSE(
        Socket(studio->port(), studio->head("GET /", studio->bearer() + "Origin: " + origin + "\r\n"))
            .accepted())
        << origin;
  }
  for (const char* host : {"evil.example", "127.0.0.1", "", "127.0.0.1:1"})
    EXPECT_EQ(studio->status("GET /api/types HTTP/1.1\r\nHost: " + std::string(host) + "\r\n" +
                             studio->bearer() + "\r\n"),
              403)
        << host;
  EXPECT_FALSE(Socket(studio->port(), studio->head("GET /?token=" + token.substr(1))).accepted());
}

TEST_F(BadInputTest, NoPathLeadsOut) {
  fs::create_directory_symlink(outside.path(), folder / "door");
  fs::create_symlink(outside / "secret.txt", folder / "window.txt");
  fs::create_symlink(outside / "new.txt", folder / "hole.txt");
  fs::create_directory(folder / "templates");
  fs::create_directory_symlink(outside.path(), folder / "templates/templates");
  start();
  const std::string up = outside.path().substr(1);
  for (const std::string& path :
       {std::string("../"), std::string("..%2f"), std::string("%2e%2e/"), std::string("%2e%2e%2f"),
        std::string("a/../../"), std::string(".%2e/"), std::string("door/"), std::string("door%2f")})
    for (const std::string& root : {std::string("/api/file/"), std::string("/")}) {
      const std::string far =
          path.starts_with("door") ? "" : path + path + path + path + path + path + up + "/";
      const std::string target = root + (path.starts_with("door") ? path : far) + "secret.txt";
      EXPECT_NE(get(target), 200) << target;
      EXPECT_NE(put(target), 200) << target;
    }
  for (const char* path :
       {"/api/file/window.txt", "/api/file//etc/passwd", "/api/file/%2fetc%2fpasswd", "/api/file/a%00b",
        "/api/file/..%5c..%5cx", "/api/file/%252e%252e%252fx", "/api/file/%ff%fe", "/api/file/",
        "/api/files?folder=door", "/api/files?folder=..", "/api/files?folder=%2fetc",
        "/api/thumbnail/secret.jpg", "/api/thumbnail/..%2fa.jpg", "/api/thumbnail/", "//etc/passwd",
        "/%2e%2e%2f%2e%2e%2fetc/passwd"})
    EXPECT_NE(get(path), 200) << path;
  EXPECT_NE(put("/api/file/window.txt"), 200);
  EXPECT_NE(put("/api/file/hole.txt"), 200);
  EXPECT_NE(put("/api/file/"), 200);
  EXPECT_NE(put("/api/file/door/new.txt"), 200);
  EXPECT_EQ(test::readFile(outside / "secret.txt"), "a secret");
  EXPECT_FALSE(fs::exists(outside / "new.txt"));
  const Socket socket = studio->socket();
  for (const char* text : {R"({"id": 1, "do": "scene.open", "path": "door/secret.json"})",
                           R"({"id": 1, "do": "scene.open", "template": "templates/secret.json"})",
                           R"({"id": 1, "do": "scene.open", "template": "../scene.json"})",
                           R"({"id": 1, "do": "scene.save", "path": "door/x.json"})",
                           R"({"id": 1, "do": "scene.save", "path": "../x.json"})"})
    EXPECT_NE(socket.ask(text).find("error"), nullptr) << text;
  EXPECT_EQ(fs::file_size(outside / "secret.txt"), 8u);
}

TEST_F(BadInputTest, UploadsThatAreTooLarge) {
  start();
  EXPECT_EQ(
      studio->status(
          studio->head("PUT /api/file/a.obj", studio->bearer() + "Content-Length: 1073741824\r\n") + "\r\n"),
      413);
  EXPECT_NE(studio->status(studio->head("PUT /api/file/a.obj", studio->bearer() + "Content-Length: -1\r\n") +
                           "\r\n"),
            200);
  // Without a length: a gigabyte in pieces. The server hangs up long before its end.
  const Connection connection(studio->port());
  connection.send(studio->head("PUT /api/file/a.obj", studio->bearer() + "Transfer-Encoding: chunked\r\n") +
                  "\r\n");
  const std::string piece = "10000\r\n" + std::string(65536, 'x') + "\r\n";
  constexpr int kPieces = 16384;
  int sent = 0;
  while (sent < kPieces && connection.send(piece)) ++sent;
  EXPECT_LT(sent, kPieces / 8);
  EXPECT_FALSE(fs::exists(folder / "a.obj"));
  const Socket socket = studio->socket();
  EXPECT_TRUE(runsOn(socket));
}

/// Bytes of memory that this process holds, the server among it. The address sanitizer keeps back what was
/// given back to it, so there only what is in use counts.
std::int64_t heldBytes() {
#ifdef WEIR_ADDRESS_SANITIZER
  return static_cast<std::int64_t>(__sanitizer_get_current_allocated_bytes());
#else
  std::int64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return pages * sysconf(_SC_PAGESIZE);
#endif
}

TEST_F(BadInputTest, UploadsTakeNoMemory) {
  constexpr std::size_t kPiece = 1 << 16;
  constexpr int kPieces = 2048, kWarm = 64;
  constexpr std::int64_t kSpare = 16 << 20;
  options.largestUpload = std::int64_t{256} << 20;
  start();
  const Connection connection(studio->port());
  connection.send(studio->head("PUT /api/file/big.obj", studio->bearer() + "Content-Length: " +
                                                            std::to_string(kPieces * kPiece) + "\r\n") +
                  "\r\n");
  const std::string piece(kPiece, 'v');
  std::int64_t before = 0;
  for (int i = 0; i < kPieces; ++i) {
    if (i == kWarm) before = heldBytes();
    ASSERT_TRUE(connection.send(piece));
  }
  // The server has read all but what the system holds for it.
  EXPECT_LT(heldBytes() - before, kSpare);
  EXPECT_FALSE(fs::exists(folder / "big.obj"));  // until it is whole
  EXPECT_TRUE(connection.readHeader().starts_with("HTTP/1.1 200"));
  EXPECT_EQ(fs::file_size(folder / "big.obj"), kPieces * kPiece);
  // Half of one leaves nothing behind.
  {
    const Connection broken(studio->port());
    broken.send(studio->head("PUT /api/file/half.obj", studio->bearer() + "Content-Length: 99999\r\n") +
                "\r\n" + piece);
  }
  const Socket socket = studio->socket();
  EXPECT_TRUE(runsOn(socket));
  for (const auto& entry : fs::directory_iterator(folder.path()))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  EXPECT_NE(put("/api/types"), 200);
  EXPECT_NE(put("/index.html"), 200);
}

TEST_F(BadInputTest, AClientThatStopsReadingIsClosedAndAllElseGoesOn) {
  start();
  const Socket writer = studio->socket();
  writer.ask(R"({"id": 1, "do": "hello"})");
  constexpr int kSmall = 4096;
  const Socket stuck = studio->socket(kSmall);
  ASSERT_TRUE(stuck.accepted());
  writer.sendText(R"({"id": 2, "do": "run.play"})");
  // It confirms what it never read, and asks for more. That ends when the server closes it.
  bool closed = false;
  for (int i = 0; i < 200'000 && !closed; ++i) {
    closed = !stuck.sendText(R"({"do": "frame.seen"})") ||
             !stuck.sendText(R"({"id": 1, "do": "run.seek", "frame": 0})") ||
             !stuck.sendText(R"({"id": 2, "do": "hello"})");
  }
  EXPECT_TRUE(closed);
  EXPECT_FALSE(writer.state("finished").isNull());
}

TEST_F(BadInputTest, ADivergingSimulationIsToldInGoodMessages) {
  start();
  const Socket socket = studio->socket();
  edit(socket, [](Value& scene) {
    scene["world"]["duration"] = 0.05;
    scene["world"]["gravity"] = Value(Value::Array{Value(3e38), Value(-3e38), Value(1e30)});
  });
  socket.ask(R"({"id": 1, "do": "run.reset"})");
  socket.sendText(R"({"id": 2, "do": "run.play"})");
  bool asked = false;
  const auto ended = socket.until([&](const Socket::Message& message) {
    if (!message.text) {
      (void)Socket::headerOf(message);  // throws if it is no JSON
      if (!asked) socket.sendText(R"({"id": 3, "do": "particle", "node": "water", "particle": 0})");
      asked = true;
      return false;
    }
    const Value value = parseJson(message.data, "message");
    const Value* event = value.find("event");
    if (event == nullptr || event->asString() != "status") return false;
    const std::string& state = value.find("data")->find("state")->asString();
    return state == "finished" || state == "failed";
  });
  EXPECT_TRUE(ended);
  EXPECT_TRUE(runsOn(socket));
}

TEST_F(BadInputTest, APluginThatThrowsFailsTheRunAlone) {
  start();
  const Socket socket = studio->socket();
  const Socket watcher = studio->socket();
  for (const char* hook : {"reset", "step", "step_no_exception", "step_check", "frame"}) {
    edit(socket, [&](Value& scene) {
      scene["nodes"]["bad"]["type"] = "FailingNode";
      scene["nodes"]["bad"]["params"]["hook"] = hook;
    });
    socket.ask(R"({"id": 1, "do": "run.reset"})");
    socket.sendText(R"({"id": 2, "do": "run.play"})");
    const Value failed = socket.state("failed");
    ASSERT_FALSE(failed.isNull()) << hook;
    const std::string text = writeJsonLine(*failed.find("problem"));
    EXPECT_NE(text.find("failing_hooks"), std::string::npos) << text;
  }
  EXPECT_TRUE(runsOn(socket));
  EXPECT_NE(watcher.ask(R"({"id": 9, "do": "hello"})").find("result"), nullptr);
}

TEST_F(BadInputTest, OneWritesAndOthersWatch) {
  start();
  const Socket writer = studio->socket();
  writer.ask(R"({"id": 1, "do": "hello"})");
  std::vector<std::unique_ptr<Socket>> watchers;
  for (int i = 0; i < 4; ++i) {
    watchers.push_back(
        std::make_unique<Socket>(studio->port(), studio->head("GET /api/live", studio->bearer())));
    EXPECT_EQ(watchers.back()->ask(R"({"id": 1, "do": "hello"})").find("result")->find("role")->asString(),
              "viewer");
    for (const char* command :
         {"scene.set", "scene.open", "scene.save", "run.reset", "run.play", "run.pause", "run.step",
          "view.set", "video.start", "video.camera", "video.stop", "scene.new", "draft.drop"}) {
      Value request = parseJson(
          R"({"id": 2, "scene": {}, "path": "x.json", "frames": 1, "attribute": "speed", "most": 9, "eye": [1, 1, 1], "target": [0, 0, 0]})",
          "request");
      request["do"] = command;
      const Value answer = watchers.back()->ask(request);
      ASSERT_NE(answer.find("error"), nullptr) << command;
      EXPECT_NE(answer.find("error")->find("message")->asString().find("pen"), std::string::npos) << command;
    }
  }
  EXPECT_FALSE(fs::exists(folder / "x.json"));
  edit(writer, [](Value& scene) { scene["world"]["duration"] = 0.02; });
  writer.ask(R"({"id": 3, "do": "run.reset"})");
  writer.sendText(R"({"id": 4, "do": "run.play"})");
  for (const auto& watcher : watchers) EXPECT_FALSE(watcher->state("finished").isNull());
}

}  // namespace
}  // namespace weir::studio
