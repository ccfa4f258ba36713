// The kinds of value that a parameter can have: how each is read from a Value, checked, and written back.
//
// A new kind is a specialisation of ParamTraits<T>:
//   kKind                          its name in `weir nodes` and for property editors
//   toValue(t)                     as it is written to a scene
//   fromValue(v, spec, place)      the checked value, or a scene Error at `place`
//   schema(spec)                   JSON Schema of it
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"
#include "framework/graph/place.h"

namespace WEIR_API weir {

/// What a parameter says of itself. Written with designated initialisers:
///   Param<float> speed{*this, "speed", 1.0f, {.unit = "m/s", .min = 0, .doc = "Speed of the jet."}};
struct ParamSpec {
  std::string_view unit = {};
  double min = -std::numeric_limits<double>::infinity();      ///< values below are refused
  double max = std::numeric_limits<double>::infinity();       ///< values above are refused
  bool aboveMin = false;                                      ///< the minimum itself is refused too
  double softMin = std::numeric_limits<double>::quiet_NaN();  ///< only a hint to property editors
  double softMax = std::numeric_limits<double>::quiet_NaN();
  int minItems = 0;       ///< least number of elements of a list or curve
  bool live = false;      ///< may change while the simulation runs; otherwise a change asks for a reset
  bool animated = false;  ///< may be given as keyframes over time, if the type is Animatable (keyframes.h)
  std::string_view doc = {};
  std::string_view onlyFor =
      {};                      ///< "shape: box, cone": refused with other choices of this enum of its owner
  std::string_view also = {};  ///< other words for it, parted by commas, by which people look for it
};

/// A colour, red, green, blue and opacity in [0, 1] (sRGB). Written as [r, g, b], [r, g, b, a] or
/// "#rrggbb[aa]".
struct Color {
  float r = 1, g = 1, b = 1, a = 1;
  friend bool operator==(const Color&, const Color&) = default;
};

/// Euler angles in degrees about the fixed x, then y, then z axis; or a unit quaternion [w, x, y, z].
struct Rotation {
  Vec3f degrees{};
  std::optional<Quatf> quaternion;
  Quatf toQuaternion() const;  ///< of length 1
  friend bool operator==(const Rotation&, const Rotation&) = default;
};

/// A file or folder. A relative path is relative to the scene file, or to what else it comes from.
struct FilePath {
  std::string text;                ///< as the scene has it; absolute if it does not come from the scene file
  std::filesystem::path resolved;  ///< where it is
  bool empty() const { return text.empty(); }
  friend bool operator==(const FilePath& a, const FilePath& b) { return a.text == b.text; }
};

/// The points of a curve, such as the profile of a surface of revolution.
struct Curve {
  std::vector<Vec2f> points;
  friend bool operator==(const Curve&, const Curve&) = default;
};

/// Specialise for an enum E to make Param<E> possible; kNames[i] is the name and doc of E(i).
template <class E>
struct EnumNames;
using EnumName = std::pair<std::string_view, std::string_view>;
template <class E>
concept NamedEnum = requires {
  EnumNames<E>::kNames.size();
};

template <class T>
struct ParamTraits;

namespace detail {
double readNumber(const Value& v, const ParamSpec& spec, const Place& place);
std::int64_t readInteger(const Value& v, const ParamSpec& spec, const Place& place, std::int64_t lo,
                         std::int64_t hi);
/// A float from a double that fits; a number too large for float is refused.
float readFloat(const Value& v, const ParamSpec& spec, const Place& place);
const Value::Array& readArray(const Value& v, const Place& place, std::size_t size, std::string_view what);
int readEnum(const Value& v, const Place& place, const EnumName* names, std::size_t count);
Value numberSchema(std::string_view type, const ParamSpec& spec);
Value arraySchema(Value item, std::size_t minItems, std::optional<std::size_t> maxItems);
Value enumSchema(const EnumName* names, std::size_t count);
}  // namespace detail

template <>
struct ParamTraits<bool> {
  static constexpr std::string_view kKind = "bool";
  static Value toValue(bool b) { return b; }
  static bool fromValue(const Value& v, const ParamSpec&, const Place& place);
  static Value schema(const ParamSpec&);
};
template <>
struct ParamTraits<int> {
  static constexpr std::string_view kKind = "int";
  static Value toValue(int i) { return i; }
  static int fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<std::int64_t> {
  static constexpr std::string_view kKind = "int";
  static Value toValue(std::int64_t i) { return i; }
  static std::int64_t fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<float> {
  static constexpr std::string_view kKind = "float";
  static Value toValue(float f) { return f; }
  static float fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<double> {
  static constexpr std::string_view kKind = "float";
  static Value toValue(double d) { return d; }
  static double fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<Vec2f> {
  static constexpr std::string_view kKind = "vec2";
  static Value toValue(const Vec2f& v);
  static Vec2f fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<Vec3f> {
  static constexpr std::string_view kKind = "vec3";
  static Value toValue(const Vec3f& v);
  static Vec3f fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<Color> {
  static constexpr std::string_view kKind = "color";
  static Value toValue(const Color& c);
  static Color fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<Rotation> {
  static constexpr std::string_view kKind = "rotation";
  static Value toValue(const Rotation& r);
  static Rotation fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<std::string> {
  static constexpr std::string_view kKind = "string";
  static Value toValue(const std::string& s) { return s; }
  static std::string fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<FilePath> {
  static constexpr std::string_view kKind = "path";
  static Value toValue(const FilePath& p) { return p.text; }
  static FilePath fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <>
struct ParamTraits<Curve> {
  static constexpr std::string_view kKind = "curve";
  static Value toValue(const Curve& c);
  static Curve fromValue(const Value& v, const ParamSpec& spec, const Place& place);
  static Value schema(const ParamSpec& spec);
};
template <NamedEnum E>
struct ParamTraits<E> {
  static constexpr std::string_view kKind = "enum";
  static Value toValue(E e) { return EnumNames<E>::kNames[static_cast<std::size_t>(e)].first; }
  static E fromValue(const Value& v, const ParamSpec&, const Place& place) {
    return E(detail::readEnum(v, place, EnumNames<E>::kNames.data(), EnumNames<E>::kNames.size()));
  }
  static Value schema(const ParamSpec&) {
    return detail::enumSchema(EnumNames<E>::kNames.data(), EnumNames<E>::kNames.size());
  }
};
/// A value that may be left open; null says so.
template <class T>
struct ParamTraits<std::optional<T>> {
  static constexpr std::string_view kKind = ParamTraits<T>::kKind;
  static Value toValue(const std::optional<T>& t) { return t ? ParamTraits<T>::toValue(*t) : Value(); }
  static std::optional<T> fromValue(const Value& v, const ParamSpec& spec, const Place& place) {
    if (v.isNull()) return std::nullopt;
    return ParamTraits<T>::fromValue(v, spec, place);
  }
  static Value schema(const ParamSpec& spec) {
    Value null = Value::object();
    null["type"] = "null";
    Value either = Value::object();
    either["anyOf"] = Value::Array{ParamTraits<T>::schema(spec), std::move(null)};
    return either;
  }
};
template <class T>
struct ParamTraits<std::vector<T>> {
  static constexpr std::string_view kKind = "list";
  static Value toValue(const std::vector<T>& items) {
    Value v = Value::array();
    for (const T& item : items) v.push(ParamTraits<T>::toValue(item));
    return v;
  }
  static std::vector<T> fromValue(const Value& v, const ParamSpec& spec, const Place& place) {
    if (!v.isArray() || v.asArray().size() < static_cast<std::size_t>(spec.minItems))
      throw place.error(v, "found " + v.brief(),
                        "a list of at least " + std::to_string(spec.minItems) + " elements");
    std::vector<T> items;
    for (std::size_t i = 0; i < v.asArray().size(); ++i)
      items.push_back(ParamTraits<T>::fromValue(v.asArray()[i], spec, place / i));
    return items;
  }
  static Value schema(const ParamSpec& spec) {
    return detail::arraySchema(ParamTraits<T>::schema(spec), static_cast<std::size_t>(spec.minItems),
                               std::nullopt);
  }
};

/// "a number above 0", "an integer in [1, 100]": what a spec allows, for messages.
std::string describeRange(std::string_view what, const ParamSpec& spec);

}  // namespace weir
