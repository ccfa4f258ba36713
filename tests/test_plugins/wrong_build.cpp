// Says that it was built by another compiler; must be refused before it is called.
#include <cstdlib>

#include <weir/plugin.h>

namespace {

constexpr weir::PluginHeader wrongHeader() {
  weir::PluginHeader header = weir::detail::pluginHeader("wrong_build", "Of another compiler.");
  weir::detail::copyText(header.build, "another compiler");
  return header;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) constinit const weir::PluginHeader weirPluginHeader =
    wrongHeader();
extern "C" __attribute__((visibility("default"))) void weirRegisterPlugin(weir::Registry&) {
  std::abort();
}
