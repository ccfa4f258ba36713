#include "framework/graph/param_types.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/graph/units.h"

namespace weir {

std::string describeRange(std::string_view what, const ParamSpec& spec) {
  const bool low = std::isfinite(spec.min), high = std::isfinite(spec.max);
  std::string text(what);
  if (low && high)
    text += fmt::format(" {} {} and at most {}", spec.aboveMin ? "above" : "of at least", spec.min, spec.max);
  else if (low)
    text += fmt::format(" {} {}", spec.aboveMin ? "above" : "of at least", spec.min);
  else if (high)
    text += fmt::format(" of at most {}", spec.max);
  if (!spec.unit.empty()) text += fmt::format(" [{}]", spec.unit);
  return text;
}

namespace detail {

namespace {

bool inRange(double x, const ParamSpec& spec) {
  return std::isfinite(x) && x <= spec.max && (spec.aboveMin ? x > spec.min : x >= spec.min);
}

Value typeSchema(std::string_view type) {
  Value schema = Value::object();
  schema["type"] = type;
  return schema;
}

/// Of a number, or of a text with a number and a unit.
std::optional<double> numberOf(const Value& v, const ParamSpec& spec, const Place& place) {
  if (v.isString()) return quantityIn(spec, v, place);
  return v.isNumber() ? std::optional(v.asDouble()) : std::nullopt;
}

}  // namespace

double readNumber(const Value& v, const ParamSpec& spec, const Place& place) {
  const std::optional<double> number = numberOf(v, spec, place);
  if (!number || !inRange(*number, spec))
    throw place.error(v, "found " + v.brief(), describeRange("a number", spec));
  return *number;
}

float readFloat(const Value& v, const ParamSpec& spec, const Place& place) {
  const double d = readNumber(v, spec, place);
  if (std::abs(d) > std::numeric_limits<float>::max())
    throw place.error(v, "found " + v.brief(), "a number that single precision holds (up to 3.4e38)");
  const float f = static_cast<float>(d);
  // A tiny positive number must not become a zero that the range excludes.
  if (spec.aboveMin && !(double(f) > spec.min))
    throw place.error(v, "found " + v.brief(), describeRange("a number", spec));
  return f;
}

std::int64_t readInteger(const Value& v, const ParamSpec& spec, const Place& place, std::int64_t lo,
                         std::int64_t hi) {
  const std::optional<double> number = numberOf(v, spec, place);
  const bool whole = v.isInt() || (number && std::abs(*number) < 1e15 && *number == std::floor(*number));
  const auto fail = [&] { return place.error(v, "found " + v.brief(), describeRange("an integer", spec)); };
  if (!whole || !inRange(*number, spec)) throw fail();
  const std::int64_t i = v.isInt() ? v.asInt() : static_cast<std::int64_t>(*number);
  if (i < lo || i > hi) throw fail();
  return i;
}

const Value::Array& readArray(const Value& v, const Place& place, std::size_t size, std::string_view what) {
  if (!v.isArray() || v.asArray().size() != size)
    throw place.error(v, "found " + v.brief(), std::string(what));
  return v.asArray();
}

int readEnum(const Value& v, const Place& place, const EnumName* names, std::size_t count) {
  std::vector<std::string> all, allQuoted;
  for (std::size_t i = 0; i < count; ++i) {
    if (v.isString() && v.asString() == names[i].first) return static_cast<int>(i);
    all.emplace_back(names[i].first);
    allQuoted.push_back(Value(names[i].first).brief());
  }
  const std::string nearest = v.isString() ? closestName(v.asString(), all) : std::string();
  throw place.error(v, "found " + v.brief(), joinNames(allQuoted),
                    nearest.empty() ? "" : "did you mean \"" + nearest + "\"?");
}

Value numberSchema(std::string_view type, const ParamSpec& spec) {
  Value schema = typeSchema(type);
  if (std::isfinite(spec.min)) schema[spec.aboveMin ? "exclusiveMinimum" : "minimum"] = spec.min;
  if (std::isfinite(spec.max)) schema["maximum"] = spec.max;
  return schema;
}

Value arraySchema(Value item, std::size_t minItems, std::optional<std::size_t> maxItems) {
  Value schema = typeSchema("array");
  schema["items"] = std::move(item);
  if (minItems > 0) schema["minItems"] = static_cast<std::int64_t>(minItems);
  if (maxItems) schema["maxItems"] = static_cast<std::int64_t>(*maxItems);
  return schema;
}

Value enumSchema(const EnumName* names, std::size_t count) {
  Value all = Value::array();
  for (std::size_t i = 0; i < count; ++i) all.push(names[i].first);
  Value schema = Value::object();
  schema["enum"] = std::move(all);
  return schema;
}

}  // namespace detail

using detail::arraySchema;
using detail::numberSchema;
using detail::readArray;

bool ParamTraits<bool>::fromValue(const Value& v, const ParamSpec&, const Place& place) {
  if (!v.isBool()) throw place.error(v, "found " + v.brief(), "true or false");
  return v.asBool();
}
Value ParamTraits<bool>::schema(const ParamSpec&) {
  return detail::typeSchema("boolean");
}

int ParamTraits<int>::fromValue(const Value& v, const ParamSpec& spec, const Place& place) {
  using Limits = std::numeric_limits<int>;
  return static_cast<int>(detail::readInteger(v, spec, place, Limits::min(), Limits::max()));
}
Value ParamTraits<int>::schema(const ParamSpec& spec) {
  return numberSchema("integer", spec);
}

std::int64_t ParamTraits<std::int64_t>::fromValue(const Value& v, const ParamSpec& spec, const Place& place) {
  using Limits = std::numeric_limits<std::int64_t>;
  return detail::readInteger(v, spec, place, Limits::min(), Limits::max());
}
Value ParamTraits<std::int64_t>::schema(const ParamSpec& spec) {
  return numberSchema("integer", spec);
}

float ParamTraits<float>::fromValue(const Value& v, const ParamSpec& spec, const Place& place) {
  return detail::readFloat(v, spec, place);
}
Value ParamTraits<float>::schema(const ParamSpec& spec) {
  return numberSchema("number", spec);
}

double ParamTraits<double>::fromValue(const Value& v, const ParamSpec& spec, const Place& place) {
  return detail::readNumber(v, spec, place);
}
Value ParamTraits<double>::schema(const ParamSpec& spec) {
  return numberSchema("number", spec);
}

Value ParamTraits<Vec2f>::toValue(const Vec2f& v) {
  return Value::Array{v.x, v.y};
}
Vec2f ParamTraits<Vec2f>::fromValue(const Value& v, const ParamSpec& spec, const Place& place) {
  const auto& a = readArray(v, place, 2, "two numbers [x, y]");
  return {detail::readFloat(a[0], spec, place / 0), detail::readFloat(a[1], spec, place / 1)};
}
Value ParamTraits<Vec2f>::schema(const ParamSpec& spec) {
  return arraySchema(numberSchema("number", spec), 2, 2);
}

Value ParamTraits<Vec3f>::toValue(const Vec3f& v) {
  return Value::Array{v.x, v.y, v.z};
}
Vec3f ParamTraits<Vec3f>::fromValue(const Value& v, const ParamSpec& spec, const Place& place) {
  const auto& a = readArray(v, place, 3, "three numbers [x, y, z]");
  return {detail::readFloat(a[0], spec, place / 0), detail::readFloat(a[1], spec, place / 1),
          detail::readFloat(a[2], spec, place / 2)};
}
Value ParamTraits<Vec3f>::schema(const ParamSpec& spec) {
  return arraySchema(numberSchema("number", spec), 3, 3);
}

namespace {

constexpr std::string_view kColorForms =
    "[r, g, b] or [r, g, b, a] in [0, 1], or \"#rrggbb\" or \"#rrggbbaa\"";

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<Color> parseHexColor(std::string_view text) {
  if ((text.size() != 7 && text.size() != 9) || text[0] != '#') return std::nullopt;
  float channels[4] = {1, 1, 1, 1};
  for (std::size_t i = 1; i < text.size(); i += 2) {
    const int high = hexDigit(text[i]), low = hexDigit(text[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    channels[i / 2] = static_cast<float>(high * 16 + low) / 255.0f;
  }
  return Color{channels[0], channels[1], channels[2], channels[3]};
}

}  // namespace

Value ParamTraits<Color>::toValue(const Color& c) {
  return c.a == 1.0f ? Value(Value::Array{c.r, c.g, c.b}) : Value(Value::Array{c.r, c.g, c.b, c.a});
}
Color ParamTraits<Color>::fromValue(const Value& v, const ParamSpec&, const Place& place) {
  if (v.isString()) {
    if (const auto color = parseHexColor(v.asString())) return *color;
  } else if (v.isArray() && (v.asArray().size() == 3 || v.asArray().size() == 4)) {
    const auto& a = v.asArray();
    const ParamSpec unit{.min = 0, .max = 1};
    return {detail::readFloat(a[0], unit, place / 0), detail::readFloat(a[1], unit, place / 1),
            detail::readFloat(a[2], unit, place / 2),
            a.size() == 4 ? detail::readFloat(a[3], unit, place / 3) : 1.0f};
  }
  throw place.error(v, "found " + v.brief(), std::string(kColorForms));
}
Value ParamTraits<Color>::schema(const ParamSpec&) {
  Value text = detail::typeSchema("string");
  text["pattern"] = "^#([0-9a-fA-F]{6}|[0-9a-fA-F]{8})$";
  Value either = Value::object();
  either["anyOf"] = Value::Array{arraySchema(numberSchema("number", {.min = 0, .max = 1}), 3, 4), text};
  return either;
}

Quatf Rotation::toQuaternion() const {
  if (!quaternion) return quaternionFromEulerDegrees(degrees);
  const Quatf& q = *quaternion;
  const float length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / length, q.x / length, q.y / length, q.z / length};
}

Value ParamTraits<Rotation>::toValue(const Rotation& r) {
  if (!r.quaternion) return ParamTraits<Vec3f>::toValue(r.degrees);
  return Value::Array{r.quaternion->w, r.quaternion->x, r.quaternion->y, r.quaternion->z};
}
Rotation ParamTraits<Rotation>::fromValue(const Value& v, const ParamSpec&, const Place& place) {
  constexpr std::string_view kForms =
      "Euler angles [x, y, z] in degrees, or a quaternion [w, x, y, z] of length 1";
  if (!v.isArray() || (v.asArray().size() != 3 && v.asArray().size() != 4))
    throw place.error(v, "found " + v.brief(), std::string(kForms));
  const auto& a = v.asArray();
  float n[4] = {};
  const ParamSpec angle{.unit = "degrees"};
  for (std::size_t i = 0; i < a.size(); ++i)
    n[i] = detail::readFloat(a[i], a.size() == 3 ? angle : ParamSpec{}, place / i);
  if (a.size() == 3) return {{n[0], n[1], n[2]}, std::nullopt};
  constexpr double kLengthTolerance = 1e-3;
  const double length =
      std::sqrt(double(n[0]) * n[0] + double(n[1]) * n[1] + double(n[2]) * n[2] + double(n[3]) * n[3]);
  if (!(std::abs(length - 1) < kLengthTolerance))
    throw place.error(v, fmt::format("found a quaternion of length {:.4g}", length), std::string(kForms));
  return {{}, Quatf{n[0], n[1], n[2], n[3]}};
}
Value ParamTraits<Rotation>::schema(const ParamSpec&) {
  return arraySchema(numberSchema("number", {}), 3, 4);
}

std::string ParamTraits<std::string>::fromValue(const Value& v, const ParamSpec&, const Place& place) {
  if (!v.isString()) throw place.error(v, "found " + v.brief(), "a string");
  return v.asString();
}
Value ParamTraits<std::string>::schema(const ParamSpec&) {
  return detail::typeSchema("string");
}

FilePath ParamTraits<FilePath>::fromValue(const Value& v, const ParamSpec&, const Place& place) {
  if (!v.isString()) throw place.error(v, "found " + v.brief(), "a path as a string");
  const std::string& text = v.asString();
  if (text.find('\0') != std::string::npos) throw place.error(v, "found a path with a zero byte", "a path");
  if (text.empty()) return {};
  const std::filesystem::path path(text);
  const std::string& folder = place.folderOf(v);
  const auto resolved = path.is_absolute() || folder.empty() ? path : std::filesystem::path(folder) / path;
  if (!v.origin) return {text, resolved};
  // A file that the scene includes has lines. What stands in it is written relative to the scene's folder.
  if (v.line > 0 && !path.is_absolute())
    return {place.folder.empty() ? resolved.string() : resolved.lexically_relative(place.folder).string(),
            resolved};
  // Written into a scene, a path from elsewhere must still lead to the same file.
  return {resolved.string(), resolved};
}
Value ParamTraits<FilePath>::schema(const ParamSpec&) {
  return detail::typeSchema("string");
}

Value ParamTraits<Curve>::toValue(const Curve& c) {
  Value v = Value::array();
  for (const Vec2f& p : c.points) v.push(ParamTraits<Vec2f>::toValue(p));
  return v;
}
Curve ParamTraits<Curve>::fromValue(const Value& v, const ParamSpec& spec, const Place& place) {
  return {ParamTraits<std::vector<Vec2f>>::fromValue(v, spec, place)};
}
Value ParamTraits<Curve>::schema(const ParamSpec& spec) {
  return ParamTraits<std::vector<Vec2f>>::schema(spec);
}

}  // namespace weir
