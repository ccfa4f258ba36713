#include "plugins/rendering/gl/shaders.h"

#include <fmt/format.h>

namespace weir::rendering::gl {

std::string placesInCircle(const std::string& name, int count, Vec2f (*placeOf)(int number, int count)) {
  std::string list;
  for (int i = 0; i < count; ++i) {
    const Vec2f place = placeOf(i, count);
    // All digits: compute kernels have the same places, and where a place is rounded to a texel, a last digit
    // can decide which.
    list += fmt::format("{}vec2({:.9g}, {:.9g})", i > 0 ? ", " : "", place.x, place.y);
  }
  const std::string size = std::to_string(count);
  return "const vec2 " + name + "[" + size + "] = vec2[" + size + "](" + list + ");\n";
}

}  // namespace weir::rendering::gl
