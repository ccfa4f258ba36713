#include "plugins/rendering/gl/functions.h"

#include "framework/base/error.h"

namespace weir::rendering {

namespace {

template <class F>
void load(const Context& context, const char* name, F& function) {
  function = reinterpret_cast<F>(context.function(name));
  if (function == nullptr) throw ioError(context.providerName() + " has no " + name, "OpenGL 3.3");
}

}  // namespace

Functions::Functions(const Context& context) {
#define WEIR_GL_LOAD(type, name) load(context, "gl" #name, name);
  WEIR_GL_FUNCTIONS(WEIR_GL_LOAD)
#undef WEIR_GL_LOAD
}

}  // namespace weir::rendering
