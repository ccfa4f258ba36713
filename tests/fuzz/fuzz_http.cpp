// Bytes that come to the studio's port. Whatever they are, nobody without the token gets what it serves, and
// the next one is served.
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/studio_server.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using Server = weir::fuzz::StudioServer;
  return weir::fuzz::withText(data, size, [](std::string_view text) {
    const std::string reply = weir::fuzz::studioServer().talk(text);
    const bool knowsToken = text.find(Server::kToken) != std::string_view::npos ||
                            text.find('%') != std::string_view::npos;  // it may stand there in another form
    if (!knowsToken && reply.find("HTTP/1.1 200") != std::string::npos) std::abort();
    static int calls = 0;
    if (++calls % 64 != 0) return;
    const std::string good = "GET /x?token=" + std::string(Server::kToken) +
                             " HTTP/1.1\r\nHost: " + std::string(Server::kHost) +
                             "\r\nConnection: close\r\n\r\n";
    if (weir::fuzz::studioServer().talk(good).find("GET /x") == std::string::npos) std::abort();
  });
}
