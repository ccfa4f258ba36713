// Says that it was built for another version of the plugin interface; must be refused before it is called.
#include <cstdlib>

#include <weir/plugin.h>

namespace {

constexpr weir::PluginHeader wrongHeader() {
  weir::PluginHeader header = weir::detail::pluginHeader("wrong_version", "Of another version.");
  header.interfaceVersion = 999;
  return header;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) constinit const weir::PluginHeader weirPluginHeader =
    wrongHeader();
extern "C" __attribute__((visibility("default"))) void weirRegisterPlugin(weir::Registry&) {
  std::abort();
}
