// Messages to the studio.
#include "apps/studio/session/message.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return weir::fuzz::withText(data, size, [](std::string_view text) {
    static_cast<void>(weir::studio::idOf(text));
    const weir::Value message = weir::studio::readMessage(text);
    static_cast<void>(weir::studio::textMember(message, "do"));
    static_cast<void>(weir::studio::pictureOptionsOf(message));
  });
}
