// Scene files as text: what is read is written and read back as the same, in a layout that stays, and what
// they have beyond JSON is expanded to what can be written.
#include "framework/scene/expand.h"
#include "framework/scene/layout.h"
#include "framework/scene/scene_file.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  weir::fuzz::withText(data, size, [](std::string_view text) {
    const weir::Value scene = weir::parseScene(text, "scene.json");
    (void)weir::writtenForm(text, scene);
    const std::string formatted = weir::formattedScene(text, "scene.json");
    if (weir::formattedScene(formatted, "scene.json") != formatted) std::abort();
    const weir::Value plain = weir::expandScene(scene, {"scene.json", "", "/no/such/folder"}, {}).plain;
    if (!(weir::parseJson(weir::writeJson(plain), "written") == plain)) std::abort();
  });
  return weir::fuzz::withText(data, size, [](std::string_view text) {
    const weir::Value value = weir::parseJson(text, "scene.json");
    if (!(weir::parseScene(text, "scene.json") == value)) std::abort();
    for (const std::string& written : {weir::writeJson(value), weir::writeJsonLine(value)})
      if (!(weir::parseJson(written, "written") == value)) std::abort();
  });
}
