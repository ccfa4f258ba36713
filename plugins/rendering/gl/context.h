// An OpenGL context that needs no window and no display server: on a GPU through EGL, or in software.
#pragma once

#include <memory>
#include <string>

#include "plugins/rendering/gl/functions.h"

namespace weir::rendering::gl {

enum class Provider {
  kAuto,    ///< EGL if it works, else OSMesa
  kEgl,     ///< a GPU through EGL's device platform, or Mesa's surfaceless platform
  kOsMesa,  ///< Mesa's off-screen library, on the CPU
};

/// A context without a default framebuffer: everything is drawn into framebuffer objects. It may be used
/// from any thread, but from one at a time, and only while a CurrentContext for it lives.
class Context {
 public:
  virtual ~Context() = default;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  /// The functions, at least those of OpenGL 3.3 core.
  const Functions& functions() const { return *functions_; }
  /// "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5 (Core Profile) Mesa 22.3.6, through OSMesa"
  const std::string& description() const { return description_; }
  /// Whether it draws on the CPU.
  bool isSoftware() const;

 protected:
  Context() = default;
  /// To be called once by each provider when its context can be made current.
  void load(FunctionFinder finder, const std::string& providerName);

  friend class CurrentContext;
  virtual void makeCurrent() = 0;
  virtual void release() noexcept = 0;

 private:
  std::unique_ptr<Functions> functions_;
  std::string description_;
};

/// Makes a context the calling thread's current one, for the lifetime of this object. Not to be nested.
class CurrentContext {
 public:
  explicit CurrentContext(Context& context) : context_(context) { context_.makeCurrent(); }
  ~CurrentContext() { context_.release(); }
  CurrentContext(const CurrentContext&) = delete;
  CurrentContext& operator=(const CurrentContext&) = delete;

 private:
  Context& context_;
};

/// The environment variable WEIR_GL (egl, osmesa or auto) decides where `wanted` is kAuto. Throws an io Error
/// that lists what was tried and why it failed if there is no context, and a usage Error for another WEIR_GL.
std::unique_ptr<Context> makeContext(Provider wanted = Provider::kAuto);

}  // namespace weir::rendering::gl
