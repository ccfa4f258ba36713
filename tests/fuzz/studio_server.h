// The studio's server on a thread of its own, for targets that talk to it as a browser would.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "apps/studio/server/http_server.h"

namespace weir::fuzz {

class StudioServer final : public studio::ServerEvents {
 public:
  StudioServer();
  ~StudioServer() override;

  /// Opens a connection, sends the bytes and says that there are no more; returns what came back until the
  /// other end closed it. Ends the process where that takes longer than kPatience. In `bytes` the text kHost
  /// stands for the server's address. If there is a `greeting`, it goes first, and the answer is waited for.
  std::string talk(std::string_view bytes, std::string_view greeting = {}) const;
  /// "GET /ws" as the page asks for it.
  static std::string upgrade();

  static constexpr std::string_view kHost = "127.0.0.1:8000", kToken = "letmein";

 private:
  static constexpr int kPatience = 15;  // s

  /// With the port that the server has.
  std::string addressed(std::string_view bytes) const;

  studio::HttpReply request(const studio::HttpRequest& request) override;
  std::filesystem::path uploadPlace(const studio::HttpRequest& request) override;
  void opened(studio::ClientId) override {}
  void message(studio::ClientId client, std::string_view text) override;
  void closed(studio::ClientId) override {}
  double shareOf(studio::ClientId) const override { return 1; }

  std::unique_ptr<studio::HttpServer> server_;
  std::thread thread_;
};

/// One for the process.
StudioServer& studioServer();

}  // namespace weir::fuzz
