// The studio's other side for tests and benchmarks: HTTP and WebSocket over real connections, and a studio
// that runs on a thread.
#pragma once

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <pthread.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>

#include "apps/studio/session/studio.h"
#include "framework/scene/scene_file.h"
#include "nodes/register_nodes.h"
#include "tests/support/child_process.h"

namespace weir::studio {

/// 125 particles for four frames.
inline constexpr const char* kBriefScene = R"({
  "weir": 1, "world": { "duration": 0.04, "frame_rate": 100 },
  "nodes": { "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.2, 0.2] } },
             "water": { "type": "ParticleFluid", "params": { "spacing": 0.04, "rest_steps": 0 } } },
  "links": ["block.particles -> water.initial"]
})";

/// A plain connection to 127.0.0.1.
class Connection {
 public:
  /// `receiveBuffer`: bytes that the system takes for those who do not read; 0 is the usual.
  explicit Connection(int port, int receiveBuffer = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receiveBuffer > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receiveBuffer, sizeof receiveBuffer);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int atOnce = 1;  // as browsers do
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &atOnce, sizeof atOnce);
    const timeval patience{120, 0};  // s, far more than a machine needs that is not busy
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
  /// Exactly that many bytes; fewer if the other side has closed.
  std::string read(std::size_t count) const {
    std::string bytes;
    while (bytes.size() < count) {
      std::array<char, 65536> block;
      const ssize_t got = ::recv(socket_, block.data(), std::min(block.size(), count - bytes.size()), 0);
      if (got < 0 && errno == EINTR) continue;
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

/// A WebSocket of the studio.
class Socket {
 public:
  Socket(int port, const std::string& head, int receiveBuffer = 0) : connection_(port, receiveBuffer) {
    connection_.send(head +
                     "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    accepted_ = connection_.readHeader().starts_with("HTTP/1.1 101");
  }
  bool accepted() const { return accepted_; }

  bool sendText(std::string_view text) const { return sendRaw(frameOf(text)); }
  /// Bytes that may not be a frame at all.
  bool sendRaw(std::string_view bytes) const { return connection_.send(bytes); }
  /// A message as it goes over the wire, masked with 0.
  static std::string frameOf(std::string_view text) {
    std::string frame{'\x81'};
    const int lengthBytes = text.size() < 126 ? 0 : text.size() < 65536 ? 2 : 8;
    const std::size_t first = lengthBytes == 0 ? text.size() : lengthBytes == 2 ? 126 : 127;
    frame += static_cast<char>(0x80 | first);
    for (int i = lengthBytes - 1; i >= 0; --i) frame += static_cast<char>(text.size() >> 8 * i & 0xff);
    frame += std::string(4, '\0');
    return frame.append(text);
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
  /// The header of a packet.
  static Value headerOf(const Message& packet) {
    std::uint32_t length = 0;
    std::memcpy(&length, packet.data.data(), sizeof length);
    return parseJson(packet.data.substr(sizeof length, length), "packet");
  }
  /// What stands behind it.
  static std::string_view payloadOf(const Message& packet) {
    std::uint32_t length = 0;
    std::memcpy(&length, packet.data.data(), sizeof length);
    return std::string_view(packet.data).substr(sizeof length + length);
  }
  /// The next message for which f is true; all else is passed over, and frames are confirmed.
  std::optional<Message> until(const std::function<bool(const Message&)>& f) const {
    while (auto message = next()) {
      if (f(*message)) return message;
      if (!message->text && headerOf(*message).find("kind")->asString() == "frame")
        sendText(R"({"do": "frame.seen"})");
    }
    return std::nullopt;
  }
  /// Waits for an event of which f is true, and gives back its data. Throws if the server closes, or says
  /// nothing for long.
  Value event(const std::string& name, const std::function<bool(const Value&)>& f) const {
    Value data;
    const auto found = until([&](const Message& message) {
      if (!message.text) return false;
      const Value value = parseJson(message.data, "event");
      const Value* of = value.find("event");
      if (of == nullptr || of->asString() != name) return false;
      data = *value.find("data");
      return f(data);
    });
    if (!found)
      throw std::runtime_error("no such event: " + name + "; the last that was told: " + writeJsonLine(data));
    return data;
  }
  /// Waits for such a state of the run.
  Value state(const std::string& name) const {
    return event("status", [&](const Value& data) { return data.find("state")->asString() == name; });
  }
  /// Sends a request and waits for the answer to it.
  Value ask(const Value& request) const {
    sendText(writeJsonLine(request));
    return answer(request.find("id")->asInt());
  }
  Value ask(const char* request) const { return ask(parseJson(request, "request")); }
  Value ask(const std::string& request) const { return ask(request.c_str()); }
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

inline double secondsOf(clockid_t clock) {
  constexpr double kNanosecond = 1e-9;
  timespec time{};
  if (clock_gettime(clock, &time) != 0) throw std::runtime_error("the system has no such clock");
  return static_cast<double>(time.tv_sec) + kNanosecond * static_cast<double>(time.tv_nsec);
}

/// A studio of one folder, on the CPU if its options name no device, which serves on a thread of its own.
class RunningStudio {
 public:
  explicit RunningStudio(StudioOptions options, const std::string& scene,
                         const std::function<void(Registry&)>& prepare = {}) {
    registerNodes(registry_);
    if (prepare) prepare(registry_);
    if (options.device == "auto") options.device = "cpu";
    studio_ = std::make_unique<Studio>(std::move(options), registry_, log_);
    if (!scene.empty()) studio_->open(scene);
    const std::string address = studio_->address();  // http://127.0.0.1:PORT/?token=TOKEN
    port_ = std::stoi(address.substr(address.rfind(':') + 1));
    token_ = address.substr(address.find('=') + 1);
    server_ = std::thread([this] { studio_->run(); });
  }
  ~RunningStudio() {
    studio_->stop();
    server_.join();
  }
  RunningStudio(const RunningStudio&) = delete;
  RunningStudio& operator=(const RunningStudio&) = delete;

  int port() const { return port_; }
  const std::string& token() const { return token_; }
  /// Seconds of a core that the server's thread has used.
  double servingSeconds() {
    clockid_t clock{};
    if (pthread_getcpuclockid(server_.native_handle(), &clock) != 0)
      throw std::runtime_error("the system does not tell what a thread has used");
    return secondsOf(clock);
  }
  std::string head(const std::string& first, const std::string& more = "") const {
    return first + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) + "\r\n" + more;
  }
  std::string bearer() const { return "Authorization: Bearer " + token_ + "\r\n"; }
  /// The whole answer to a request: the header and what follows until the server closes.
  std::string answer(const std::string& first) const {
    const Connection connection(port_);
    connection.send(head(first, bearer() + "Connection: close\r\n") + "\r\n");
    return connection.read(std::size_t{1} << 30);
  }
  /// The status of the answer to a request.
  int status(const std::string& request) const {
    const Connection connection(port_);
    connection.send(request);
    const std::string header = connection.readHeader();
    return header.size() > 12 ? std::stoi(header.substr(9, 3)) : 0;
  }
  Socket socket(int receiveBuffer = 0) const {
    return {port_, head("GET /api/live", bearer()), receiveBuffer};
  }

 private:
  Registry registry_;
  Log log_;
  std::unique_ptr<Studio> studio_;
  std::thread server_;
  int port_ = 0;
  std::string token_;
};

}  // namespace weir::studio
