// What a plugin, a shared library that adds to the registry at run time, says of itself. It ends with
//
//   WEIR_PLUGIN("vortex", "A vortex force.", registry) { registry.addModule<VortexForce>(); }
//
// The macro defines two C symbols. The host (plugin.h) reads the first, plain data, and compares interface
// version, Weir's headers and build before it calls anything of the plugin.
#pragma once

#include <cstddef>

#include "framework/base/api.h"
#include "framework/graph/interface_digest.h"
#include "framework/graph/registry.h"

namespace WEIR_API weir {

/// Grows whenever PluginHeader changes. All other headers are told apart by kInterfaceIdentity.
inline constexpr int kPluginInterface = 2;

namespace detail {

/// Text that is put together while compiling.
struct BuildText {
  char text[112] = {};
  std::size_t size = 0;

  constexpr BuildText& add(const char* more) {
    for (; *more != 0 && size + 1 < sizeof text; ++more) text[size++] = *more;
    return *this;
  }
  constexpr BuildText& add(long number) {
    if (number >= 10) add(number / 10);
    const char digit[2] = {static_cast<char>('0' + number % 10), 0};
    return add(digit);
  }
};

/// What must be equal for two C++ libraries to share types: the compiler's and the standard library's ABI.
/// A CUDA back end may be in one alone: see dispatch() in framework/compute/dispatch.h.
constexpr BuildText pluginBuild() {
  BuildText build;
#if defined(__GXX_ABI_VERSION)
  build.add("Itanium C++ ABI");
#else
  build.add("unknown C++ ABI");
#endif
#if defined(_GLIBCXX_USE_CXX11_ABI)
  build.add(", libstdc++ ").add(_GLIBCXX_USE_CXX11_ABI ? "C++11 ABI" : "old ABI");
#elif defined(_LIBCPP_ABI_VERSION)
  build.add(", libc++ ABI ").add(static_cast<long>(_LIBCPP_ABI_VERSION));
#endif
  build.add(", C++").add(__cplusplus / 100 % 100);
  return build;
}

}  // namespace detail

inline constexpr detail::BuildText kPluginBuild = detail::pluginBuild();

/// Plain data, so that it can be read before anything is called.
struct PluginHeader {
  char magic[8];  ///< "WEIRPLG"
  int interfaceVersion;
  int headerSize;
  char interfaceIdentity[64];  ///< the versions of Weir and its interface, and a digest of its public headers
  char build[112];
  int hasCudaKernels;  ///< 1 if it was built with nvcc
  char name[64];
  char doc[256];
};

namespace detail {
template <std::size_t N>
constexpr void copyText(char (&to)[N], const char* from) {
  for (std::size_t i = 0; i + 1 < N && from[i] != 0; ++i) to[i] = from[i];
}
constexpr PluginHeader pluginHeader(const char* name, const char* doc) {
  PluginHeader header{};
  copyText(header.magic, "WEIRPLG");
  header.interfaceVersion = kPluginInterface;
  header.headerSize = sizeof(PluginHeader);
  copyText(header.interfaceIdentity, kInterfaceIdentity);
  copyText(header.build, kPluginBuild.text);
#ifdef WEIR_HAS_CUDA
  header.hasCudaKernels = 1;
#endif
  copyText(header.name, name);
  copyText(header.doc, doc);
  return header;
}
}  // namespace detail

}  // namespace weir

// A macro, because the two symbols must be defined at namespace scope with C linkage.
#define WEIR_PLUGIN(pluginName, pluginDoc, registry)                                                        \
  extern "C" __attribute__((visibility("default"))) constinit const ::weir::PluginHeader weirPluginHeader = \
      ::weir::detail::pluginHeader(pluginName, pluginDoc);                                                  \
  extern "C" __attribute__((visibility("default"))) void weirRegisterPlugin(::weir::Registry& registry)
