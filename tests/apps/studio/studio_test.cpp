// The studio as a browser sees it: HTTP and WebSocket, over a real connection.
#ifdef WEIR_HAS_STUDIO
#include "apps/studio/session/studio.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <random>
#include <thread>

#include "nodes/register_nodes.h"
#include "tests/support/child_process.h"

namespace weir::studio {
namespace {

constexpr const char* kScene = R"({
  "weir": 1, "world": { "duration": 0.04, "frame_rate": 100 },
  "nodes": { "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.2, 0.2] } },
             "water": { "type": "ParticleFluid", "params": { "spacing": 0.04, "rest_steps": 0 } } },
  "links": ["block.particles -> water.initial"]
})";

/// A plain connection to 127.0.0.1.
class Connection {
 public:
  explicit Connection(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{20, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0)
      throw std::runtime_error("cannot connect");
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  /// Exactly so many bytes; fewer if the other side has closed.
  std::string read(std::size_t count) const {
    std::string bytes;
    while (bytes.size() < count) {
      std::array<char, 4096> block;
      const ssize_t got = ::recv(socket_, block.data(), std::min(block.size(), count - bytes.size()), 0);
      if (got <= 0) break;
      bytes.append(block.data(), static_cast<std::size_t>(got));
    }
    return bytes;
  }
  std::string readHeader() const {
    std::string text;
    while (text.find("\r\n\r\n") == std::string::npos) {
      const std::string next = read(1);
      if (next.empty()) break;
      text += next;
    }
    return text;
  }

 private:
  int socket_;
};

class StudioTest : public testing::Test {
 protected:
  StudioTest() {
    folder.write("scene.json", kScene);
    registerNodes(registry);
    StudioOptions options;
    options.folder = folder.path();
    options.page = folder / "page";
    options.templates = folder / "templates";
    options.types = "{}";
    options.device = "cpu";
    options.threads = 1;
    studio = std::make_unique<Studio>(options, registry, log);
    studio->open("scene.json");
    const std::string address = studio->address();  // http://127.0.0.1:PORT/?token=TOKEN
    port = std::stoi(address.substr(address.rfind(':') + 1));
    token = address.substr(address.find('=') + 1);
    server = std::thread([this] { studio->run(); });
  }
  ~StudioTest() override {
    studio->stop();
    server.join();
  }

  std::string head(const std::string& first, const std::string& more = "") const {
    return first + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + more;
  }
  std::string bearer() const { return "Authorization: Bearer " + token + "\r\n"; }
  /// The status of the answer to a request.
  int status(const std::string& request) const {
    const Connection connection(port);
    connection.send(request);
    const std::string header = connection.readHeader();
    return header.size() > 12 ? std::stoi(header.substr(9, 3)) : 0;
  }

  test::TemporaryFolder folder;
  Registry registry;
  Log log;
  std::unique_ptr<Studio> studio;
  std::thread server;
  int port = 0;
  std::string token;
};

/// A WebSocket of the studio.
class Socket {
 public:
  Socket(int port, const std::string& head) : connection_(port) {
    connection_.send(head +
                     "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    accepted_ = connection_.readHeader().starts_with("HTTP/1.1 101");
  }
  bool accepted() const { return accepted_; }

  bool sendText(std::string_view text) const {
    std::string frame{'\x81'};
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else {
      frame += '\xfe';
      frame += static_cast<char>(text.size() >> 8);
      frame += static_cast<char>(text.size() & 0xff);
    }
    frame += std::string(4, '\0');  // the mask
    return connection_.send(frame.append(text));
  }
  struct Message {
    bool text = false;
    std::string data;
  };
  /// The next message; empty if the server closed.
  std::optional<Message> next() const {
    const std::string start = connection_.read(2);
    if (start.size() < 2 || (start[0] & 0x0f) == 8) return std::nullopt;
    std::size_t length = static_cast<unsigned char>(start[1]) & 0x7f;
    const std::size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (more > 0) length = 0;
    for (const char c : connection_.read(more)) length = length << 8 | static_cast<unsigned char>(c);
    return Message{(start[0] & 0x0f) == 1, connection_.read(length)};
  }
  /// The answer to the request of this id; all else is passed over.
  Value answer(std::int64_t id) const {
    while (const auto message = next()) {
      if (!message->text) continue;
      Value value = parseJson(message->data, "answer");
      if (const Value* of = value.find("id"); of != nullptr && *of == Value(id)) return value;
    }
    return {};
  }

 private:
  Connection connection_;
  bool accepted_ = false;
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
#endif
