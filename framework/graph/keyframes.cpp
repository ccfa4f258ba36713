#include "framework/graph/keyframes.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/base/turn.h"

namespace weir::detail {

namespace {

constexpr const char* kForm = "an object {\"keyframes\": [[time, value], ...]}, times in s";
constexpr std::size_t kMaxKeyframes = 100000;

double readTime(const Value& key, const Place& place) {
  if (!key.isArray() || key.asArray().size() != 2)
    throw place.error(key, "found " + key.brief(), "a keyframe [time, value]");
  return readNumber(key.asArray()[0], {.unit = "s", .min = 0}, place / 0);
}

}  // namespace

const Value::Array& readKeyframes(const Value& v, const Place& place) {
  for (const auto& [name, member] : v.asObject())
    if (name != "keyframes")
      throw(place / name).error(member, "keyframes have no member '" + name + "'", kForm);
  const Value& list = *v.find("keyframes");
  const Place here = place / "keyframes";
  if (!list.isArray() || list.asArray().empty())
    throw here.error(list, "found " + list.brief(), "a list of keyframes [time, value], at least one");
  if (list.asArray().size() > kMaxKeyframes)
    throw here.error(list, fmt::format("found {} keyframes", list.asArray().size()),
                     fmt::format("at most {}", kMaxKeyframes));
  double before = -1;
  for (std::size_t i = 0; i < list.asArray().size(); ++i) {
    const Value& key = list.asArray()[i];
    const double time = readTime(key, here / i);
    if (time <= before)
      throw(here / i / 0)
          .error(key.asArray()[0], fmt::format("found a time of {} s after one of {} s", time, before),
                 "times that increase");
    before = time;
  }
  return list.asArray();
}

Place placeOfKeyframe(const Place& place, std::size_t i) {
  return place / "keyframes" / i / 1;
}

Value keyframesSchema(Value plain) {
  const auto typed = [](std::string_view type) {
    Value schema = Value::object();
    schema["type"] = type;
    return schema;
  };
  Value time = typed("number");
  time["minimum"] = 0;
  Value key = typed("array");
  key["prefixItems"] = Value::Array{std::move(time), plain};
  key["minItems"] = key["maxItems"] = 2;
  Value animated = typed("object");
  animated["properties"]["keyframes"] = arraySchema(std::move(key), 1, kMaxKeyframes);
  animated["required"] = Value::Array{"keyframes"};
  animated["additionalProperties"] = false;
  Value either = Value::object();
  either["anyOf"] = Value::Array{std::move(plain), std::move(animated)};
  return either;
}

double interpolate(double a, double b, double t) {
  return std::lerp(a, b, t);
}
float interpolate(float a, float b, double t) {
  return static_cast<float>(std::lerp(double(a), double(b), t));
}
Vec3f interpolate(const Vec3f& a, const Vec3f& b, double t) {
  return {interpolate(a.x, b.x, t), interpolate(a.y, b.y, t), interpolate(a.z, b.z, t)};
}
namespace {

/// K. Shoemake, Animating Rotation with Quaternion Curves, 1985: sin((1−t)·θ)/sin θ·a + sin(t·θ)/sin θ·b,
/// where cos θ = a·b. Of b and −b, which turn alike, the one is meant that is nearer to a.
Quatf shortestTurn(const Quatf& a, const Quatf& b, double t) {
  constexpr double kSmall = 1e-6;  // rad: the arc is as long as its chord
  const double angle = 0.5 * shortestAngle(a, b);
  double ofA = 1 - t, ofB = t;
  if (angle > kSmall) {
    ofA = std::sin((1 - t) * angle) / std::sin(angle);
    ofB = std::sin(t * angle) / std::sin(angle);
  }
  if (dot(a, b) < 0) ofB = -ofB;
  const auto sum = [&](float x, float y) { return static_cast<float>(ofA * x + ofB * y); };
  return {sum(a.w, b.w), sum(a.x, b.x), sum(a.y, b.y), sum(a.z, b.z)};
}

}  // namespace

Rotation interpolate(const Rotation& a, const Rotation& b, double t) {
  if (!a.quaternion && !b.quaternion) return {interpolate(a.degrees, b.degrees, t), std::nullopt};
  if (t <= 0 || t >= 1) return t <= 0 ? a : b;
  return {{}, shortestTurn(a.toQuaternion(), b.toQuaternion(), t)};
}

}  // namespace weir::detail
