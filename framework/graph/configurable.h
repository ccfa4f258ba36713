// Self-describing parameters. A class derives from Configurable and declares its parameters as members:
//
//   class SquareEmitter : public Node {
//     Param<float> speed{*this, "speed", 1.0f, {.unit = "m/s", .min = 0, .doc = "Speed of the jet."}};
//   };
//
// From that one line come reading, validation, writing, the JSON Schema, `weir nodes`, and property editors.
// A Group<T> nests another Configurable as an object, a GroupList<T> as a list of objects.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/check.h"
#include "framework/graph/keyframes.h"
#include "framework/graph/param_types.h"

namespace WEIR_API weir {

class Configurable;

/// One named member of a Configurable: a Param, a Group or a GroupList.
class Property {
 public:
  Property(Configurable& owner, std::string_view name, const ParamSpec& spec);
  virtual ~Property() = default;
  Property(const Property&) = delete;
  Property& operator=(const Property&) = delete;

  const std::string& name() const { return name_; }
  const ParamSpec& spec() const { return spec_; }

  virtual std::string_view kind() const = 0;
  virtual Value value() const = 0;
  virtual Value defaultValue() const = 0;
  virtual Value schema() const = 0;
  /// All checks, then the change; after an Error the old value stands.
  virtual void assign(const Value& v, const Place& place) = 0;
  /// What puts back the present value, without any check.
  virtual std::function<void()> undo() = 0;
  /// Takes the value of a simulated time in s where it is given by keyframes.
  virtual void animate(double /*time*/) {}
  /// The names of an enum with their docs; empty for other kinds.
  virtual std::vector<EnumName> choices() const { return {}; }
  /// The nested parameters of a group; null for other kinds.
  virtual const Configurable* group() const { return nullptr; }

  /// Under which choices of which other parameter of its owner it means anything; empty if always.
  struct Condition {
    std::string parameter;
    std::vector<std::string> choices;
  };
  std::optional<Condition> condition() const;

  /// Whether a scene, an option or a program has set it.
  bool isSet() const { return origin_.has_value(); }
  /// Where it was set; all empty if it was not, or not by a file.
  Location origin() const { return origin_.value_or(Location{}); }

 protected:
  std::optional<Location> origin_;

 private:
  std::string name_;
  ParamSpec spec_;
};

class Configurable {
 public:
  Configurable() = default;
  virtual ~Configurable() = default;
  Configurable(const Configurable&) = delete;
  Configurable& operator=(const Configurable&) = delete;

  const std::vector<Property*>& properties() const { return properties_; }
  Property* findProperty(std::string_view name) const;

  /// Assigns the members of an object by name. Transactional: after an Error, all old values stand. Unknown
  /// names are errors that suggest the nearest one.
  void assignAll(const Value& object, const Place& place);
  /// The parameters that differ from their defaults, as assignAll reads them.
  Value changedValues() const;
  Value schema() const;
  /// Gives all parameters that are given by keyframes their values at a simulated time in s. Keyframes are
  /// checked when they are assigned, and so are the values between them; validate() does not run here.
  void animate(double time);
  /// Adds to an error that names one of the parameters where that parameter stands.
  Error& locate(Error& error) const;

  /// Checks that concern several parameters; throws a scene Error. Runs at the end of every assignAll.
  virtual void validate() const {}

 private:
  friend class Property;
  /// Throws a scene Error for what is given and means nothing under the choices that are made.
  void refuseUnused() const;

  std::vector<Property*> properties_;
};

template <class T>
class Param final : public Property {
 public:
  Param(Configurable& owner, std::string_view name, T initial, const ParamSpec& spec = {})
      : Property(owner, name, spec), value_(initial), default_(std::move(initial)) {
    WEIR_CHECK((Animatable<T> || !spec.animated));
  }

  /// At the time of the last animate(), if it is given by keyframes.
  const T& get() const { return value_; }
  operator const T&() const { return value_; }
  const T* operator->() const { return &value_; }
  const T& operator*() const { return value_; }

  /// At a simulated time in s, whatever animate() was called with.
  T at(double time) const {
    if constexpr (Animatable<T>)
      if (!keyframes_.empty()) return keyframes_.at(time);
    return value_;
  }
  /// The mean over a time from `from` to `to`, from < to, in s: exact where keyframes give the value.
  double mean(double from, double to) const requires std::floating_point<T> {
    return keyframes_.empty() ? double(value_) : keyframes_.mean(from, to);
  }

  /// The largest from `from` to `to`, from <= to, in s.
  T max(double from, double to) const requires std::floating_point<T> {
    return keyframes_.empty() ? value_ : keyframes_.max(from, to);
  }

  /// Checked like a value from a scene.
  void set(const T& value) { assign(ParamTraits<T>::toValue(value), {}); }

  /// The fastest change from `from` to `to`, per s; 0 without keyframes. See Keyframes::fastest.
  template <class Distance>
  double fastest(double from, double to, const Distance& distance) const requires Animatable<T> {
    return keyframes_.fastest(from, to, distance);
  }

  std::string_view kind() const override { return ParamTraits<T>::kKind; }
  /// As a scene has it: keyframes where there are any.
  Value value() const override {
    if constexpr (Animatable<T>)
      if (!keyframes_.empty()) return keyframes_.toValue();
    return ParamTraits<T>::toValue(value_);
  }
  Value defaultValue() const override { return ParamTraits<T>::toValue(default_); }
  Value schema() const override {
    Value plain = ParamTraits<T>::schema(spec());
    return spec().animated ? detail::keyframesSchema(std::move(plain)) : plain;
  }
  void assign(const Value& v, const Place& place) override {
    try {
      if (isKeyframes(v)) {
        assignKeyframes(v, place);
      } else {
        value_ = ParamTraits<T>::fromValue(v, spec(), place);
        keyframes_ = {};
      }
    } catch (Error& e) {
      throw e.inParameter(name());
    }
    origin_ = place.of(v);
  }
  std::function<void()> undo() override {
    return [this, value = value_, keyframes = keyframes_, origin = origin_] {
      value_ = value, keyframes_ = keyframes, origin_ = origin;
    };
  }
  void animate(double time) override {
    if constexpr (Animatable<T>)
      if (!keyframes_.empty()) value_ = keyframes_.at(time);
  }
  std::vector<EnumName> choices() const override {
    if constexpr (NamedEnum<T>)
      return {EnumNames<T>::kNames.begin(), EnumNames<T>::kNames.end()};
    else
      return {};
  }

 private:
  void assignKeyframes(const Value& v, const Place& place) {
    if constexpr (Animatable<T>) {
      if (spec().animated) {
        keyframes_ = Keyframes<T>(v, spec(), place);
        value_ = keyframes_.at(0);
        return;
      }
    }
    throw place.error(v, "found keyframes, but this parameter cannot change over time",
                      "a plain value: " + std::string(ParamTraits<T>::kKind));
  }

  T value_;
  T default_;
  typename detail::KeyframesOf<T>::type keyframes_;
};

// Compiled once, in configurable.cpp, and not for each file that has such a parameter.
extern template class Param<bool>;
extern template class Param<int>;
extern template class Param<std::int64_t>;
extern template class Param<float>;
extern template class Param<double>;
extern template class Param<Vec2f>;
extern template class Param<Vec3f>;
extern template class Param<Color>;
extern template class Param<Rotation>;
extern template class Param<std::string>;
extern template class Param<FilePath>;
extern template class Param<Curve>;
extern template class Param<std::optional<std::int64_t>>;
extern template class Param<std::optional<float>>;
extern template class Param<std::optional<double>>;
extern template class Param<std::optional<Vec2f>>;
extern template class Param<std::optional<Vec3f>>;

/// A nested object of parameters.
template <class T>
class Group final : public Property {
 public:
  Group(Configurable& owner, std::string_view name, std::string_view doc)
      : Property(owner, name, ParamSpec{.doc = doc}) {}

  T* operator->() { return &group_; }
  const T* operator->() const { return &group_; }
  const T& operator*() const { return group_; }
  T& operator*() { return group_; }

  std::string_view kind() const override { return "group"; }
  Value value() const override { return group_.changedValues(); }
  Value defaultValue() const override { return Value::object(); }
  Value schema() const override { return group_.schema(); }
  void assign(const Value& v, const Place& place) override {
    group_.assignAll(v, place);
    origin_ = place.of(v);
  }
  std::function<void()> undo() override {
    std::vector<std::function<void()>> members;
    for (Property* property : group_.properties()) members.push_back(property->undo());
    return [this, members = std::move(members), origin = origin_] {
      for (const auto& restore : members) restore();
      origin_ = origin;
    };
  }
  void animate(double time) override { group_.animate(time); }
  const Configurable* group() const override { return &group_; }

 private:
  T group_;
};

/// A list of nested objects of parameters.
template <class T>
class GroupList final : public Property {
 public:
  GroupList(Configurable& owner, std::string_view name, std::string_view doc)
      : Property(owner, name, ParamSpec{.doc = doc}) {}

  std::size_t size() const { return items_.size(); }
  bool empty() const { return items_.empty(); }
  const T& operator[](std::size_t i) const { return *items_[i]; }

  std::string_view kind() const override { return "group list"; }
  Value value() const override {
    Value list = Value::array();
    for (const auto& item : items_) list.push(item->changedValues());
    return list;
  }
  Value defaultValue() const override { return Value::array(); }
  Value schema() const override { return detail::arraySchema(prototype_.schema(), 0, std::nullopt); }
  void assign(const Value& v, const Place& place) override {
    if (!v.isArray()) throw place.error(v, "found " + v.brief(), "a list of objects").inParameter(name());
    if (v.asArray().size() > kMaxItems)
      throw place
          .error(v, "found a list of " + std::to_string(v.asArray().size()) + " objects",
                 "at most " + std::to_string(kMaxItems))
          .inParameter(name());
    std::vector<std::shared_ptr<T>> items;
    for (std::size_t i = 0; i < v.asArray().size(); ++i) {
      items.push_back(std::make_shared<T>());
      items.back()->assignAll(v.asArray()[i], place / i);
    }
    items_ = std::move(items);
    origin_ = place.of(v);
  }
  std::function<void()> undo() override {
    return [this, items = items_, origin = origin_] { items_ = items, origin_ = origin; };
  }
  void animate(double time) override {
    for (const auto& item : items_) item->animate(time);
  }
  const Configurable* group() const override { return &prototype_; }

 private:
  static constexpr std::size_t kMaxItems = 10000;  // each costs some kilobytes

  T prototype_;
  std::vector<std::shared_ptr<T>> items_;  // only animated once here, so undo() may share them
};

}  // namespace weir
