// OpenGL without a screen: a context from OSMesa (software) or EGL (GPU or software), loaded at run time.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace weir::rendering {

enum class Provider { kAuto, kOsmesa, kEgl };

/// "osmesa", "egl" or "auto"; throws a usage Error for anything else.
Provider providerFromName(std::string_view name);
/// What the environment variable WEIR_GL says; kAuto if it is not set.
Provider providerFromEnvironment();

/// A current OpenGL 3.3 core context of this thread. It has no picture of its own: draw into framebuffer
/// objects.
class Context {
 public:
  virtual ~Context() = default;
  virtual void makeCurrent() = 0;
  virtual void* function(const char* name) const = 0;
  /// "OSMesa" or "EGL".
  virtual std::string providerName() const = 0;
};

/// kAuto takes a GPU by EGL if there is one, then OSMesa, then EGL in software. Throws an io Error that says
/// what was tried, why it failed, and what to install.
std::unique_ptr<Context> makeContext(Provider provider = Provider::kAuto);

/// The name of the renderer behind a current context, such as "llvmpipe (LLVM 15.0.6, 256 bits)".
std::string rendererName(const Context& context);

}  // namespace weir::rendering
