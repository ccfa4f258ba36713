// Frames that a viewer sends to the studio, behind a handshake that is right.
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/studio_server.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return weir::fuzz::withText(data, size, [](std::string_view text) {
    const std::string reply = weir::fuzz::studioServer().talk(text, weir::fuzz::StudioServer::upgrade());
    if (reply.find("101 Switching Protocols") == std::string::npos) std::abort();
  });
}
