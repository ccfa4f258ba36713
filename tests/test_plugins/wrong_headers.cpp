// Says that it was compiled against other headers of Weir; must be refused before it is called.
#include <cstdlib>

#include <weir/plugin.h>

namespace {

constexpr weir::PluginHeader wrongHeader() {
  weir::PluginHeader header = weir::detail::pluginHeader("wrong_headers", "Of other headers.");
  weir::detail::copyText(header.interfaceIdentity, "0.0.9, headers 0123456789abcdef");
  return header;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) constinit const weir::PluginHeader weirPluginHeader =
    wrongHeader();
extern "C" __attribute__((visibility("default"))) void weirRegisterPlugin(weir::Registry&) {
  std::abort();
}
