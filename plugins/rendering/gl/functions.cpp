#include "plugins/rendering/gl/functions.h"

#include <string>

#include "framework/base/error.h"

namespace weir::rendering::gl {

FunctionFinder::Found FunctionFinder::operator()(const char* name) const {
  const GenericFunction address = lookup_(name);
  if (!address)
    throw ioError(std::string("the OpenGL driver has no function ") + name, "a driver with OpenGL 3.3");
  return {address};
}

}  // namespace weir::rendering::gl
