#include "plugins/rendering/gl/shaders.h"

namespace weir::rendering::gl {

std::string placesInCircle(const std::string& name, int count, Vec2f (*placeOf)(int number, int count)) {
  std::string list;
  for (int i = 0; i < count; ++i) {
    const Vec2f place = placeOf(i, count);
    list += (i ? ", vec2(" : "vec2(") + std::to_string(place.x) + ", " + std::to_string(place.y) + ")";
  }
  const std::string size = std::to_string(count);
  return "const vec2 " + name + "[" + size + "] = vec2[" + size + "](" + list + ");\n";
}

}  // namespace weir::rendering::gl
