#include <array>

#include "framework/base/error.h"
#include "plugins/rendering/gl/providers.h"

namespace weir::rendering::gl {
namespace {

// OSMesa's own header includes the old GL/gl.h, which does not go with glcorearb.h.
using OsMesaHandle = struct osmesa_context*;
enum OsMesaAttribute : int {
  kRgba = 0x1908,
  kFormat = 0x22,
  kDepthBits = 0x30,
  kProfile = 0x33,
  kCoreProfile = 0x34,
  kMajorVersion = 0x36,
  kMinorVersion = 0x37,
};

struct OsMesaFunctions {
  DriverLibrary library{{"libOSMesa.so.8", "libOSMesa.so.6"}};  // first, for those below

  OsMesaHandle (*createContextAttribs)(const int* attributes,
                                       OsMesaHandle shared) = library.function("OSMesaCreateContextAttribs");
  GLboolean (*makeCurrent)(OsMesaHandle, void* buffer, GLenum type, GLsizei width,
                           GLsizei height) = library.function("OSMesaMakeCurrent");
  void (*destroyContext)(OsMesaHandle) = library.function("OSMesaDestroyContext");
  GenericFunction (*getProcAddress)(const char* name) = library.function("OSMesaGetProcAddress");
};

class OsMesaContext final : public Context {
 public:
  OsMesaContext() {
    for (const auto& [major, minor] : kVersions) {
      const std::array<int, 11> attributes{kFormat,       kRgba, kDepthBits,    24,    kProfile, kCoreProfile,
                                           kMajorVersion, major, kMinorVersion, minor, 0};
      handle_ = mesa_.createContextAttribs(attributes.data(), nullptr);
      if (handle_) break;
    }
    if (!handle_) throw ioError("it gives no core context of version 4.5, 4.3 or 3.3");
    try {
      const CurrentContext current(*this);
      load(FunctionFinder(mesa_.getProcAddress), "OSMesa");
    } catch (...) {
      mesa_.destroyContext(handle_);
      throw;
    }
  }
  ~OsMesaContext() override { mesa_.destroyContext(handle_); }

 private:
  void makeCurrent() override {
    // Mesa wants a buffer; nothing is drawn into it.
    if (!mesa_.makeCurrent(handle_, buffer_.data(), GL_UNSIGNED_BYTE, 1, 1))
      throw ioError("OSMesa cannot make its context current");
  }
  void release() noexcept override { mesa_.makeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

  OsMesaFunctions mesa_;
  std::array<unsigned char, 4> buffer_{};
  OsMesaHandle handle_ = nullptr;
};

}  // namespace

std::unique_ptr<Context> makeOsMesaContext() {
  return std::make_unique<OsMesaContext>();
}

}  // namespace weir::rendering::gl
