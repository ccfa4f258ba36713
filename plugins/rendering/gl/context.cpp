#include "plugins/rendering/gl/context.h"

#include <dlfcn.h>

#include <cstdlib>
#include <string_view>

#include "framework/base/error.h"
#include "plugins/rendering/gl/providers.h"

namespace weir::rendering::gl {
namespace {

Provider providerFromEnvironment() {
  const char* text = std::getenv("WEIR_GL");
  const std::string_view name = text ? text : "";
  if (name.empty() || name == "auto") return Provider::kAuto;
  if (name == "egl") return Provider::kEgl;
  if (name == "osmesa") return Provider::kOsMesa;
  throw usageError("the environment variable WEIR_GL is \"" + std::string(name) + "\"",
                   "auto, egl or osmesa");
}

std::vector<Way> waysFor(Provider provider) {
  const Way device{"EGL on a GPU", makeEglDeviceContext};
  const Way surfaceless{"EGL without a surface", makeEglSurfacelessContext};
  const Way osMesa{"OSMesa", makeOsMesaContext};
  switch (provider) {
    case Provider::kEgl:
      return {device, surfaceless};
    case Provider::kOsMesa:
      return {osMesa};
    case Provider::kAuto:
      break;
  }
  return {device, surfaceless, osMesa};
}

}  // namespace

void Context::load(FunctionFinder finder, const std::string& providerName) {
  functions_ = std::make_unique<Functions>(std::move(finder));
  const auto text = [&](GLenum name) {
    const GLubyte* bytes = functions_->getString(name);
    return std::string(bytes ? reinterpret_cast<const char*>(bytes) : "unknown");
  };
  description_ = text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION) + ", through " + providerName;
}

bool Context::isSoftware() const {
  for (const char* renderer : {"llvmpipe", "softpipe", "swrast", "SwiftShader"})
    if (description_.find(renderer) != std::string::npos) return true;
  return false;
}

DriverLibrary::DriverLibrary(const std::vector<std::string>& fileNames) {
  std::string reasons;
  for (const std::string& name : fileNames) {
    handle_ = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    fileName_ = name;
    if (handle_) return;
    const char* reason = dlerror();
    reasons += (reasons.empty() ? "" : "; ") + std::string(reason ? reason : name + " cannot be opened");
  }
  throw ioError(reasons);
}

FunctionFinder::Found DriverLibrary::function(const char* name) const {
  const auto address = reinterpret_cast<GenericFunction>(dlsym(handle_, name));
  if (!address) throw ioError(fileName_ + " has no function " + name);
  return {address};
}

std::unique_ptr<Context> firstThatWorks(const std::vector<Way>& ways) {
  std::string reasons;
  for (const Way& way : ways) {
    try {
      return way.make();
    } catch (const Error& error) {
      reasons += (reasons.empty() ? "" : ". ") + way.name + ": " + error.message();
    }
  }
  throw ioError("pictures cannot be drawn: no OpenGL context (3.3 or later) can be had. " + reasons, {},
                "install libegl1 and libgl1-mesa-dri, or libosmesa6 (Debian, Ubuntu), or mesa-libEGL and "
                "mesa-dri-drivers "
                "(Fedora); on a machine with a GPU, its driver's EGL library");
}

std::unique_ptr<Context> makeContext(Provider wanted) {
  return firstThatWorks(waysFor(wanted == Provider::kAuto ? providerFromEnvironment() : wanted));
}

}  // namespace weir::rendering::gl
