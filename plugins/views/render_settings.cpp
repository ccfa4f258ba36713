#include "plugins/views/render_settings.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "plugins/views/color_file.h"

namespace weir::rendering {

void CameraSettings::validate() const {
  if (length(up.get()) == 0) throw sceneError("up is [0, 0, 0]", "a direction").inParameter(up.name());
  if (eye.get() && target.get() && *eye.get() == *target.get())
    throw sceneError("eye and target are the same point", "two points").inParameter(eye.name());
  if (orbitPeriod.get() && *orbitPeriod.get() == 0)
    throw sceneError("orbit_period is 0", "a time above or below 0").inParameter(orbitPeriod.name());
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    if (keyframes[i].eye.get() == keyframes[i].target.get())
      throw sceneError("eye and target of keyframe " + std::to_string(i) + " are the same point",
                       "two points")
          .inParameter(keyframes.name());
    if (i > 0 && !(keyframes[i].time > keyframes[i - 1].time))
      throw sceneError("keyframe " + std::to_string(i) + " is not after the one before", "times that grow")
          .inParameter(keyframes.name());
  }
}

void NamedCameraSettings::validate() const {
  CameraSettings::validate();
  const auto plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  if (name->empty() || !std::all_of(name->begin(), name->end(), plain))
    throw sceneError("a camera is called " + inQuotes(*name), "letters, digits, _ and -")
        .inParameter(name.name());
}

void RenderSettings::validate() const {
  for (std::size_t i = 0; i < cameras.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (*cameras[i].name == *cameras[k].name)
        throw sceneError("two cameras are called " + inQuotes(*cameras[i].name), "a name of its own for each")
            .inParameter(cameras.name());
}

void ColorSettings::validate() const {
  const auto& ends = range.get();
  if (ends && !(ends->x < ends->y))
    throw sceneError("the range is empty", "[low, high] with low below high").inParameter(range.name());
  if (!table->empty() && !file->empty())
    throw sceneError("the colours are given by a table and by a file", "one of them")
        .inParameter(file.name());
  if (table->size() == 1)
    throw sceneError("the table has one colour", "two or more").inParameter(table.name());
}

ColorMap ColorSettings::colorMap() const {
  if (!file->empty()) return ColorMap(readColorFile(file->resolved));
  if (table->empty()) return ColorMap(map);
  std::vector<Vec3f> colors;
  for (const Color& c : table.get()) colors.push_back({c.r, c.g, c.b});
  return ColorMap(colors);
}

void ClipSettings::validate() const {
  if (length(normal.get()) == 0)
    throw sceneError("normal is [0, 0, 0]", "a direction").inParameter(normal.name());
}

std::string PlotSettings::caption() const {
  const std::string& name = label->empty() ? of : label;
  return unit->empty() ? name : name + " in " + *unit;
}

void EnvironmentSettings::validate() const {
  if (length(sun.get()) == 0) throw sceneError("sun is [0, 0, 0]", "a direction").inParameter(sun.name());
  if (look == EnvironmentLook::kImage && image->empty())
    throw sceneError("the look is \"image\", but there is none", "\"image\": a .hdr file")
        .inParameter(look.name());
  if (look != EnvironmentLook::kImage && !image->empty())
    throw sceneError("there is an image, but the look is not \"image\"", "\"look\": \"image\"")
        .inParameter(image.name());
}

Color SurfaceSettings::shownColor() const {
  constexpr Color kGrey{0.75f, 0.77f, 0.8f, 1}, kClear{0.94f, 0.97f, 0.97f, 1};
  return color.get().value_or(look == SurfaceLook::kGlass ? kClear : kGrey);
}

void SurfaceSettings::validate() const {
  if (color.get() && color.get()->a != 1)
    throw sceneError("the colour of a surface has an opacity", "[red, green, blue]",
                     "\"look\": \"glass\" makes a surface transparent")
        .inParameter(color.name());
}

}  // namespace weir::rendering
