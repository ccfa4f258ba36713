#include "tests/fuzz/studio_server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "framework/base/error.h"

namespace weir::fuzz {

namespace {

[[noreturn]] void fail(const char* what) {
  std::perror(what);
  std::abort();
}

/// Signals come at any time, as libFuzzer has a timer: the call that one has interrupted is made again.
template <class Call>
auto again(const Call& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// Of a connection whose connect() was interrupted, which goes on by itself.
bool getsConnected(int file) {
  pollfd ready{.fd = file, .events = POLLOUT, .revents = 0};
  int error = 0;
  socklen_t size = sizeof error;
  return again([&] { return ::poll(&ready, 1, -1); }) == 1 &&
         ::getsockopt(file, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
}

int connectTo(int port, int patience) {
  const int file = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const timeval wait{.tv_sec = patience, .tv_usec = 0};
  ::setsockopt(file, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
  ::setsockopt(file, SOL_SOCKET, SO_SNDTIMEO, &wait, sizeof wait);
  // Reset when it is closed, so that no port stays behind for a minute.
  const linger reset{.l_onoff = 1, .l_linger = 0};
  ::setsockopt(file, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
  if (::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 &&
      !(errno == EINTR && getsConnected(file)))
    fail("connect");
  return file;
}

}  // namespace

StudioServer::StudioServer() {
  studio::ServerOptions options;
  options.token = kToken;
  options.largestUpload = 1 << 16;
  options.largestMessage = 1 << 16;
  options.maxWaitingBytes = 1 << 20;
  server_ = std::make_unique<studio::HttpServer>(options, *this);
  thread_ = std::thread([this] { server_->run(); });
}

StudioServer::~StudioServer() {
  server_->stop();
  thread_.join();
}

studio::HttpReply StudioServer::request(const studio::HttpRequest& request) {
  if (request.path.empty() || request.path[0] != '/') throw usageError("a path that begins otherwise");
  std::string body = request.method + " " + request.path;
  for (const auto& [name, value] : request.query) body += "\n" + name + "=" + value;
  return {.body = body, .isForeign = request.query.contains("foreign")};
}

std::filesystem::path StudioServer::uploadPlace(const studio::HttpRequest& request) {
  if (request.query.contains("refused")) throw usageError("refused");
  return "/dev/shm/weir_fuzz_upload_" + std::to_string(::getpid());
}

void StudioServer::message(studio::ClientId client, std::string_view text) {
  server_->sendText(client, std::string(text));
  if (text == "binary") server_->sendBinary(client, std::make_shared<const std::string>(1000, 'x'));
}

std::string StudioServer::upgrade() {
  return "GET /ws HTTP/1.1\r\nHost: " + std::string(kHost) +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" + "Authorization: Bearer " +
         std::string(kToken) + "\r\nSec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n" +
         "Sec-WebSocket-Version: 13\r\n\r\n";
}

std::string StudioServer::addressed(std::string_view bytes) const {
  const std::string host = "127.0.0.1:" + std::to_string(server_->port());
  std::string sent(bytes);
  for (std::size_t at = 0; (at = sent.find(kHost, at)) != std::string::npos; at += host.size())
    sent.replace(at, kHost.size(), host);
  return sent;
}

std::string StudioServer::talk(std::string_view bytes, std::string_view greeting) const {
  const int file = connectTo(server_->port(), kPatience);
  std::string received;
  // What is refused is closed before all is sent.
  const auto send = [&](std::string_view text) {
    const std::string sent = addressed(text);
    again([&] { return ::send(file, sent.data(), sent.size(), MSG_NOSIGNAL); });
  };
  const auto receive = [&] {
    char block[1 << 14];
    const ssize_t count = again([&] { return ::recv(file, block, sizeof block, 0); });
    if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) fail("the server does not answer");
    if (count > 0) received.append(block, static_cast<std::size_t>(count));
    return count > 0;
  };
  if (!greeting.empty()) {
    send(greeting);
    while (received.find("\r\n\r\n") == std::string::npos && receive()) continue;
  }
  send(bytes);
  ::shutdown(file, SHUT_WR);
  while (receive()) continue;
  ::close(file);
  return received;
}

StudioServer& studioServer() {
  static StudioServer server;
  return server;
}

}  // namespace weir::fuzz
