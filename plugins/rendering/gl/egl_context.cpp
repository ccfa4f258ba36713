#define EGL_NO_X11  // a macro of the EGL headers: no window system's types are wanted
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <fmt/format.h>

#include <array>

#include "framework/base/error.h"
#include "plugins/rendering/gl/providers.h"

namespace weir::rendering::gl {
namespace {

struct EglFunctions {
  DriverLibrary library{{"libEGL.so.1", "libEGL.so"}};  // first: the members below are initialised with it

  PFNEGLGETPROCADDRESSPROC getProcAddress = library.function("eglGetProcAddress");
  PFNEGLQUERYSTRINGPROC queryString = library.function("eglQueryString");
  PFNEGLGETERRORPROC getError = library.function("eglGetError");
  PFNEGLINITIALIZEPROC initialize = library.function("eglInitialize");
  PFNEGLBINDAPIPROC bindApi = library.function("eglBindAPI");
  PFNEGLCHOOSECONFIGPROC chooseConfig = library.function("eglChooseConfig");
  PFNEGLCREATECONTEXTPROC createContext = library.function("eglCreateContext");
  PFNEGLDESTROYCONTEXTPROC destroyContext = library.function("eglDestroyContext");
  PFNEGLMAKECURRENTPROC makeCurrent = library.function("eglMakeCurrent");

  template <class F>
  F extension(const char* name) const {
    const auto address = reinterpret_cast<F>(getProcAddress(name));
    if (!address) throw ioError(std::string("the EGL library has no function ") + name);
    return address;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw ioError(fmt::format("{} (EGL error {:#x})", what, static_cast<unsigned>(getError())));
  }
};

bool hasWord(const char* words, const std::string& word) {
  return words && (" " + std::string(words) + " ").find(" " + word + " ") != std::string::npos;
}

class EglContext final : public Context {
 public:
  /// Several contexts may share a display, so it is never terminated.
  EglContext(const EglFunctions& egl, EGLDisplay display, const std::string& name)
      : egl_(egl), display_(display) {
    if (!egl_.initialize(display_, nullptr, nullptr)) egl_.fail("the display cannot be initialised");
    if (!hasWord(egl_.queryString(display_, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context"))
      throw ioError("the driver lacks EGL_KHR_surfaceless_context");
    if (!egl_.bindApi(EGL_OPENGL_API)) egl_.fail("the driver has no desktop OpenGL");
    create();
    try {
      const CurrentContext current(*this);
      load(FunctionFinder([this](const char* function) { return egl_.getProcAddress(function); }), name);
    } catch (...) {
      egl_.destroyContext(display_, handle_);
      throw;
    }
  }
  ~EglContext() override { egl_.destroyContext(display_, handle_); }

 private:
  void create() {
    constexpr std::array<EGLint, 5> kConfig{EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                            EGL_PBUFFER_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!egl_.chooseConfig(display_, kConfig.data(), &config, 1, &count) || count == 0)
      egl_.fail("there is no configuration for OpenGL");
    for (const auto& [major, minor] : kVersions) {
      const std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                             major,
                                             EGL_CONTEXT_MINOR_VERSION,
                                             minor,
                                             EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                             EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                             EGL_NONE};
      handle_ = egl_.createContext(display_, config, EGL_NO_CONTEXT, attributes.data());
      if (handle_ != EGL_NO_CONTEXT) return;
    }
    egl_.fail("it gives no core context of version 4.5, 4.3 or 3.3");
  }

  void makeCurrent() override {
    // The bound interface belongs to the thread, so another thread than the constructor's must bind it too.
    if (!egl_.bindApi(EGL_OPENGL_API) || !egl_.makeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, handle_))
      egl_.fail("the context cannot be made current");
  }
  void release() noexcept override {
    egl_.makeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

  EglFunctions egl_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext handle_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<Context> makeEglDeviceContext() {
  const EglFunctions egl;
  const auto queryDevices = egl.extension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto queryDevice = egl.extension<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  const auto displayOf = egl.extension<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  std::array<EGLDeviceEXT, 32> devices{};
  EGLint count = 0;
  if (!queryDevices(static_cast<EGLint>(devices.size()), devices.data(), &count))
    egl.fail("the devices cannot be listed");
  std::string reasons;
  for (int i = 0; i < count; ++i) {
    // The software device is what the surfaceless platform gives as well.
    if (hasWord(queryDevice(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software")) continue;
    try {
      const EGLDisplay display = displayOf(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr);
      if (display == EGL_NO_DISPLAY) egl.fail("it has no display");
      return std::make_unique<EglContext>(egl, display, "EGL device " + std::to_string(i));
    } catch (const Error& error) {
      reasons += "; device " + std::to_string(i) + ": " + error.message();
    }
  }
  throw ioError("no GPU can be used" + reasons);
}

std::unique_ptr<Context> makeEglSurfacelessContext() {
  const EglFunctions egl;
  const auto displayOf = egl.extension<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  const EGLDisplay display =
      displayOf(EGL_PLATFORM_SURFACELESS_MESA, reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY), nullptr);
  if (display == EGL_NO_DISPLAY) egl.fail("the EGL library has no surfaceless platform");
  return std::make_unique<EglContext>(egl, display, "EGL");
}

}  // namespace weir::rendering::gl
