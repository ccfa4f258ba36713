// HTTP and WebSocket on one port, for one user's browser. Everything runs on the thread that calls run();
// Boost stays in the .cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "apps/studio/server/access.h"

namespace weir::studio {

struct HttpRequest {
  std::string method;                        ///< "GET"
  std::string path;                          ///< decoded, begins with '/'
  std::map<std::string, std::string> query;  ///< decoded
  std::filesystem::path upload;              ///< of a PUT: the file that holds its body, see uploadPlace()
};

struct HttpReply {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  /// A file of somebody else: a browser shows it in a sandbox, where nothing in it runs.
  bool isForeign = false;
};

/// One open WebSocket.
using ClientId = std::uint64_t;

/// What the server calls, on its own thread. Exceptions of request() become replies, those of message() close
/// the client.
class ServerEvents {
 public:
  virtual ~ServerEvents() = default;
  virtual HttpReply request(const HttpRequest& request) = 0;
  /// Where the body of a PUT is written as it comes, so that it takes no memory. request() follows when it is
  /// whole, and must move the file away: what still lies there is removed. Throws an Error to refuse it.
  virtual std::filesystem::path uploadPlace(const HttpRequest& request) = 0;
  virtual void opened(ClientId client) = 0;
  virtual void message(ClientId client, std::string_view text) = 0;
  virtual void closed(ClientId client) = 0;
  /// The share of the server's thread, 0 to 1, that a client may take for long, see Allowance.
  virtual double shareOf(ClientId client) const = 0;
};

struct ServerOptions {
  std::string host = "127.0.0.1";  ///< the address to listen at
  int port = 0;                    ///< 0: any free one
  std::string token;
  std::int64_t largestUpload = 0;           ///< the body of a PUT, bytes
  std::int64_t largestMessage = 0;          ///< of a WebSocket, bytes
  std::int64_t maxWaitingBytes = 64 << 20;  ///< bytes that a client may be behind before it is closed
  int maxConnections = 64;                  ///< of those who know the token
  /// That have not yet said who they are; a further one takes the place of the oldest.
  int maxStrangers = 64;
};

class HttpServer {
 public:
  /// Listens from here on. Throws an io Error if the address cannot be had.
  HttpServer(const ServerOptions& options, ServerEvents& events);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int port() const;
  const AccessRules& access() const;

  /// Serves until stop().
  void run();

  // The rest may be called from any thread.
  void stop();
  /// Calls f on the server's thread.
  void post(std::function<void()> f);
  void sendText(ClientId client, std::string text);
  void sendBinary(ClientId client, std::shared_ptr<const std::string> bytes);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace weir::studio
