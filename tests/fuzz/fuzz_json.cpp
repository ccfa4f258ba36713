// Scene files as text: what is read is written and read back as the same.
#include "framework/scene/scene_file.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return weir::fuzz::withText(data, size, [](std::string_view text) {
    const weir::Value value = weir::parseJson(text, "scene.json");
    for (const std::string& written : {weir::writeJson(value), weir::writeJsonLine(value)})
      if (!(weir::parseJson(written, "written") == value)) std::abort();
  });
}
