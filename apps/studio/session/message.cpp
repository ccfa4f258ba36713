#include "apps/studio/session/message.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "framework/base/error.h"
#include "framework/scene/scene_file.h"

namespace weir::studio {

namespace {

/// Not less than the number of values in a text of JSON.
std::size_t valuesIn(std::string_view text) {
  std::size_t count = 1;
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') inString = !inString;
    if (inString && c == '\\') ++i;
    if (!inString && (c == ',' || c == '[' || c == '{')) ++count;
  }
  return count;
}

}  // namespace

Value readMessage(std::string_view text) {
  if (valuesIn(text) > kMaxMessageValues)
    throw usageError("the message holds too many values", "at most " + std::to_string(kMaxMessageValues),
                     "large data belongs into files of its own, which the scene names");
  Value message = parseJson(text, "message");
  if (!message.isObject()) throw usageError("a message is " + message.brief(), "an object");
  return message;
}

std::optional<std::int64_t> idOf(std::string_view text) {
  const auto skip = [&](std::string_view word) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    const bool there = text.starts_with(word);
    if (there) text.remove_prefix(word.size());
    return there;
  };
  if (!skip("{") || !skip("\"id\"") || !skip(":")) return std::nullopt;
  (void)skip("");
  std::int64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end == text.data() + text.size() || *end == '.' || *end == 'e' || *end == 'E')
    return std::nullopt;
  return id;
}

const Value& member(const Value& message, std::string_view name) {
  const Value* v = message.find(name);
  if (v == nullptr) throw usageError("the message has no '" + std::string(name) + "'");
  return *v;
}

std::string textMember(const Value& message, std::string_view name) {
  const Value& v = member(message, name);
  if (!v.isString()) throw usageError("'" + std::string(name) + "' is " + v.brief(), "a string");
  return v.asString();
}

std::int64_t wholeMember(const Value& message, std::string_view name, std::int64_t min, std::int64_t max) {
  const Value& v = member(message, name);
  if (!v.isInt() || v.asInt() < min || v.asInt() > max)
    throw usageError("'" + std::string(name) + "' is " + v.brief(),
                     "a whole number from " + std::to_string(min) + " to " + std::to_string(max));
  return v.asInt();
}

std::optional<std::int64_t> frameMember(const Value& message) {
  if (message.find("frame") == nullptr) return std::nullopt;
  return wholeMember(message, "frame", 0, std::numeric_limits<std::int64_t>::max());
}

bool switchMember(const Value& message, std::string_view name) {
  const Value& v = member(message, name);
  if (!v.isBool()) throw usageError("'" + std::string(name) + "' is " + v.brief(), "true or false");
  return v.asBool();
}

Vec3f pointMember(const Value& message, std::string_view name) {
  constexpr double kFarthest = 1e6;
  const Value& v = member(message, name);
  Vec3f result;
  bool good = v.isArray() && v.asArray().size() == 3;
  for (int i = 0; good && i < 3; ++i) {
    const Value& component = v.asArray()[static_cast<std::size_t>(i)];
    good = component.isNumber() && std::abs(component.asDouble()) <= kFarthest;
    if (good) result[i] = static_cast<float>(component.asDouble());
  }
  if (!good) throw usageError("'" + std::string(name) + "' is " + v.brief(), "[x, y, z] in metres");
  return result;
}

LiveCamera cameraOf(const Value& message) {
  constexpr double kNarrowest = 1, kWidest = 170;
  LiveCamera camera;
  camera.eye = pointMember(message, "eye");
  camera.target = pointMember(message, "target");
  if (message.find("up") != nullptr) camera.up = pointMember(message, "up");
  if (const Value* fov = message.find("fov")) {
    if (!fov->isNumber() || !(fov->asDouble() >= kNarrowest && fov->asDouble() <= kWidest))
      throw usageError("'fov' is " + fov->brief(), "1 to 170 degrees");
    camera.fovDegrees = static_cast<float>(fov->asDouble());
  }
  if (length(camera.eye - camera.target) == 0 || length(camera.up) == 0)
    throw usageError("the camera looks nowhere", "an eye beside the target, and an up that is not 0");
  return camera;
}

LivePictureOptions pictureOptionsOf(const Value& message) {
  constexpr std::int64_t kMin = 16, kMax = 4096, kMaxSamples = 4;
  LivePictureOptions options;
  options.camera = cameraOf(message);
  const auto whole = [&](std::string_view name, std::int64_t min, std::int64_t max, int& to) {
    if (message.find(name) != nullptr) to = static_cast<int>(wholeMember(message, name, min, max));
  };
  whole("width", kMin, kMax, options.width);
  whole("height", kMin, kMax, options.height);
  whole("samples", 1, kMaxSamples, options.samplesPerAxis);
  return options;
}

}  // namespace weir::studio
