#include "plugins/rendering/gl/context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir::rendering {

namespace {

constexpr int kMajor = 3, kMinor = 3;

/// A shared library, loaded by the first of some names. It stays loaded, because drivers leave threads
/// behind.
class Library {
 public:
  explicit Library(std::initializer_list<const char*> names) {
    for (const char* name : names) {
      handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
      if (handle_ != nullptr) return;
    }
    throw ioError(std::string(*names.begin()) + " is not installed");
  }
  template <class F>
  F* function(const char* name) const {
    void* found = dlsym(handle_, name);
    if (found == nullptr) throw ioError(std::string("its library has no ") + name);
    return reinterpret_cast<F*>(found);
  }

 private:
  void* handle_ = nullptr;
};

class OsmesaContext final : public Context {
 public:
  OsmesaContext() : library_({"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
    // From GL/osmesa.h, which is not installed where only the library is.
    constexpr int kFormat = 0x22, kDepthBits = 0x30, kProfile = 0x33, kCoreProfile = 0x34,
                  kMajorVersion = 0x36, kMinorVersion = 0x37;
    const std::array<int, 11> attributes{
        kFormat,       GL_RGBA, kDepthBits,    0,      kProfile, kCoreProfile,
        kMajorVersion, kMajor,  kMinorVersion, kMinor, 0};
    const auto create = library_.function<void*(const int*, void*)>("OSMesaCreateContextAttribs");
    makeCurrent_ = library_.function<unsigned char(void*, void*, GLenum, int, int)>("OSMesaMakeCurrent");
    destroy_ = library_.function<void(void*)>("OSMesaDestroyContext");
    address_ = library_.function<void*(const char*)>("OSMesaGetProcAddress");
    context_ = create(attributes.data(), nullptr);
    if (context_ == nullptr) throw ioError("it has no OpenGL 3.3");
    makeCurrent();
  }
  ~OsmesaContext() override { destroy_(context_); }

  void makeCurrent() override {
    if (makeCurrent_(context_, pixels_.data(), GL_UNSIGNED_BYTE, kSize, kSize) == 0)
      throw ioError("its context cannot be made current");
  }
  void* function(const char* name) const override { return address_(name); }
  std::string providerName() const override { return "OSMesa"; }

 private:
  static constexpr int kSize = 16;  // of the picture that it insists on

  Library library_;
  unsigned char (*makeCurrent_)(void*, void*, GLenum, int, int) = nullptr;
  void (*destroy_)(void*) = nullptr;
  void* (*address_)(const char*) = nullptr;
  void* context_ = nullptr;
  std::vector<unsigned char> pixels_ = std::vector<unsigned char>(4 * kSize * kSize);
};

class EglContext final : public Context {
 public:
  /// Without `hardwareOnly`, Mesa's software renderer will do.
  explicit EglContext(bool hardwareOnly) : library_({"libEGL.so.1"}) {
    address_ = library_.function<void*(const char*)>("eglGetProcAddress");
    std::string reasons;
    for (EGLDisplay display : displays()) {
      if (const std::string reason = open(display, hardwareOnly); reason.empty())
        return;
      else
        reasons += (reasons.empty() ? "" : ", ") + reason;
    }
    throw ioError(reasons.empty() ? "it has no display without a screen" : reasons);
  }
  ~EglContext() override { close(); }

  void makeCurrent() override {
    if (call<EGLBoolean(EGLDisplay, EGLSurface, EGLSurface, EGLContext_)>("eglMakeCurrent")(
            display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE)
      throw ioError("its context cannot be made current");
  }
  void* function(const char* name) const override { return address_(name); }
  std::string providerName() const override { return "EGL"; }

 private:
  using EGLContext_ = ::EGLContext;

  template <class F>
  F* call(const char* name) const {
    void* found = address_(name);
    return found != nullptr ? reinterpret_cast<F*>(found) : library_.function<F>(name);
  }

  /// One for each device, then Mesa's display without any.
  std::vector<EGLDisplay> displays() const {
    std::vector<EGLDisplay> all;
    const auto getDisplay =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(address_("eglGetPlatformDisplayEXT"));
    if (getDisplay == nullptr) return all;
    const auto add = [&](EGLenum platform, void* native) {
      const EGLDisplay display = getDisplay(platform, native, nullptr);
      if (display != EGL_NO_DISPLAY) all.push_back(display);
    };
    constexpr EGLint kMostDevices = 32;
    std::array<EGLDeviceEXT, kMostDevices> devices{};
    EGLint count = 0;
    const auto queryDevices = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(address_("eglQueryDevicesEXT"));
    if (queryDevices != nullptr && queryDevices(kMostDevices, devices.data(), &count) != EGL_FALSE)
      for (EGLint i = 0; i < count; ++i) add(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)]);
    add(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
    return all;
  }

  /// Makes the context current, or says why it cannot.
  std::string open(EGLDisplay display, bool hardwareOnly) {
    if (call<EGLBoolean(EGLDisplay, EGLint*, EGLint*)>("eglInitialize")(display, nullptr, nullptr) ==
        EGL_FALSE)
      return "a display cannot be initialised";
    display_ = display;
    const EGLint configAttributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                       EGL_NONE};
    const EGLint contextAttributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                        kMajor,
                                        EGL_CONTEXT_MINOR_VERSION,
                                        kMinor,
                                        EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                        EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    call<EGLBoolean(EGLenum)>("eglBindAPI")(EGL_OPENGL_API);
    call<EGLBoolean(EGLDisplay, const EGLint*, EGLConfig*, EGLint, EGLint*)>("eglChooseConfig")(
        display, configAttributes, &config, 1, &configs);
    context_ = call<EGLContext_(EGLDisplay, EGLConfig, EGLContext_, const EGLint*)>("eglCreateContext")(
        display, configs > 0 ? config : nullptr, EGL_NO_CONTEXT, contextAttributes);
    if (context_ == EGL_NO_CONTEXT) return close(), "a display has no OpenGL 3.3";
    try {
      makeCurrent();
    } catch (const Error& e) {
      return close(), e.message();
    }
    const std::string renderer = rendererName(*this);
    const bool software =
        renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos;
    if (hardwareOnly && software) return close(), "there is no GPU";
    return {};
  }

  void close() {
    if (display_ == EGL_NO_DISPLAY) return;
    call<EGLBoolean(EGLDisplay, EGLSurface, EGLSurface, EGLContext_)>("eglMakeCurrent")(
        display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_ != EGL_NO_CONTEXT)
      call<EGLBoolean(EGLDisplay, EGLContext_)>("eglDestroyContext")(display_, context_);
    context_ = EGL_NO_CONTEXT;
    display_ = EGL_NO_DISPLAY;  // not terminated: other contexts of this process may share it
  }

  Library library_;
  void* (*address_)(const char*) = nullptr;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext_ context_ = EGL_NO_CONTEXT;
};

}  // namespace

Provider providerFromName(std::string_view name) {
  if (name == "auto") return Provider::kAuto;
  if (name == "osmesa") return Provider::kOsmesa;
  if (name == "egl") return Provider::kEgl;
  throw usageError("WEIR_GL is " + inQuotes(name), "auto, osmesa or egl");
}

Provider providerFromEnvironment() {
  const char* name = std::getenv("WEIR_GL");
  return name == nullptr || *name == 0 ? Provider::kAuto : providerFromName(name);
}

std::unique_ptr<Context> makeContext(Provider provider) {
  using Maker = std::unique_ptr<Context> (*)();
  const std::pair<const char*, Maker> hardware{"EGL on a GPU",
                                               [] { return std::unique_ptr<Context>(new EglContext(true)); }};
  const std::pair<const char*, Maker> osmesa{"OSMesa",
                                             [] { return std::unique_ptr<Context>(new OsmesaContext); }};
  const std::pair<const char*, Maker> egl{"EGL",
                                          [] { return std::unique_ptr<Context>(new EglContext(false)); }};
  std::vector<std::pair<const char*, Maker>> candidates{hardware, osmesa, egl};
  if (provider == Provider::kOsmesa) candidates = {osmesa};
  if (provider == Provider::kEgl) candidates = {hardware, egl};

  std::string reasons;
  for (const auto& [name, make] : candidates) {
    try {
      return make();
    } catch (const Error& e) {
      reasons += (reasons.empty() ? "" : "; ") + std::string(name) + ": " + e.message();
    }
  }
  throw ioError("pictures cannot be drawn, as there is no OpenGL 3.3 without a screen (" + reasons + ")",
                "OSMesa or EGL",
                "install libosmesa6, or libegl1 and libgl1-mesa-dri; 'weir info' shows what works");
}

std::string rendererName(const Context& context) {
  const auto getString = reinterpret_cast<PFNGLGETSTRINGPROC>(context.function("glGetString"));
  if (getString == nullptr) return "unknown";
  const auto* name = getString(GL_RENDERER);
  return name != nullptr ? reinterpret_cast<const char*>(name) : "unknown";
}

}  // namespace weir::rendering
