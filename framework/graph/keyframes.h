// Parameters that change over simulated time. In a scene, such a parameter may be given as
//
//   "speed": { "keyframes": [[0, 1.0], [2, 3.0]] }
//
// in place of a plain value: pairs of a time in s and the value then. Between two times the value is linear,
// before the first and after the last it stays as it is there. A step uses the value of its beginning.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

#include "framework/graph/param_types.h"

namespace weir {

namespace detail {

/// The list of a value {"keyframes": [...]}, each element checked to be a pair whose first is a time in s
/// that is later than that of the element before. Throws a scene Error at the element's place.
const Value::Array& readKeyframes(const Value& v, const Place& place);
/// Where the value of keyframe i stands.
Place placeOfKeyframe(const Place& place, std::size_t i);
/// JSON Schema of a plain value or of keyframes of such values.
Value keyframesSchema(Value plain);

// Between two values, for t in [0, 1]: never beyond them, and exactly one of them at the ends.
float interpolate(float a, float b, double t);
double interpolate(double a, double b, double t);
Vec3f interpolate(const Vec3f& a, const Vec3f& b, double t);
/// Of two triples of angles these are interpolated, so that turns of more than 180 degrees are possible;
/// where one of the two is a quaternion, it is the shortest turn at a constant rate.
Rotation interpolate(const Rotation& a, const Rotation& b, double t);

}  // namespace detail

/// What may be declared with `.animated = true`.
template <class T>
concept Animatable = requires(const T& a) {
  { detail::interpolate(a, a, 0.5) } -> std::same_as<T>;
};

/// Whether a scene gives keyframes here, and no plain value.
inline bool isKeyframes(const Value& v) {
  return v.find("keyframes") != nullptr;
}

template <Animatable T>
class Keyframes {
 public:
  /// None.
  Keyframes() = default;
  /// From {"keyframes": [...]}; throws a scene Error where something is wrong.
  Keyframes(const Value& v, const ParamSpec& spec, const Place& place) {
    const Value::Array& list = detail::readKeyframes(v, place);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Place here = detail::placeOfKeyframe(place, i);
      const Value& value = list[i].asArray()[1];
      keys_.emplace_back(list[i].asArray()[0].asDouble(), ParamTraits<T>::fromValue(value, spec, here));
    }
  }

  bool empty() const { return keys_.empty(); }

  Value toValue() const {
    Value list = Value::array();
    for (const auto& [time, value] : keys_) list.push(Value::Array{time, ParamTraits<T>::toValue(value)});
    Value v = Value::object();
    v["keyframes"] = std::move(list);
    return v;
  }

  /// There must be at least one keyframe.
  T at(double time) const { return valueAt<T>(time); }

  /// The mean from `from` to `to`, from < to: exact, as the sum of the trapezoids between the keyframes is.
  double mean(double from, double to) const requires std::floating_point<T> {
    double sum = 0, left = from;
    const auto addUpTo = [&](double right) {
      sum += (right - left) * 0.5 * (valueAt<double>(left) + valueAt<double>(right));
      left = right;
    };
    for (auto key = firstAfter(from); key != keys_.end() && key->first < to; ++key) addUpTo(key->first);
    addUpTo(to);
    return sum / (to - from);
  }

  /// The largest value from `from` to `to`, from <= to.
  T max(double from, double to) const requires std::floating_point<T> {
    T max = std::max(at(from), at(to));
    for (auto key = firstAfter(from); key != keys_.end() && key->first < to; ++key)
      max = std::max(max, key->second);
    return max;
  }

  /// The fastest change from `from` to `to`, from <= to, per s; distance(a, b) says how far two values are
  /// apart.
  template <class Distance>
  double fastest(double from, double to, const Distance& distance) const {
    double fastest = 0;
    for (std::size_t i = 1; i < keys_.size(); ++i) {
      const auto& [begin, before] = keys_[i - 1];
      const auto& [end, after] = keys_[i];
      if (begin <= to && end >= from) fastest = std::max(fastest, distance(before, after) / (end - begin));
    }
    return fastest;
  }

 private:
  using Key = std::pair<double, T>;

  auto firstAfter(double time) const {
    return std::upper_bound(keys_.begin(), keys_.end(), time,
                            [](double t, const Key& key) { return t < key.first; });
  }
  /// U is T, or double for what T would round.
  template <class U>
  U valueAt(double time) const {
    const auto after = firstAfter(time);
    if (after == keys_.begin()) return static_cast<U>(keys_.front().second);
    const auto before = after - 1;
    if (after == keys_.end()) return static_cast<U>(before->second);
    return detail::interpolate(static_cast<U>(before->second), static_cast<U>(after->second),
                               (time - before->first) / (after->first - before->first));
  }

  std::vector<Key> keys_;  // times increase
};

namespace detail {
/// What a parameter of another type has in their place.
struct NoKeyframes {};
template <class T>
struct KeyframesOf {
  using type = NoKeyframes;
};
template <Animatable T>
struct KeyframesOf<T> {
  using type = Keyframes<T>;
};
}  // namespace detail

}  // namespace weir
