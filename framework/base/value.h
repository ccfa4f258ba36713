// A JSON-like value that remembers where in its file it stood.
//
// Scene files, --set options and parameters all speak Value, so that no JSON library's type leaves the scene
// room, and an error about any value can name its line and column.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// Where a value comes from that is not from the file being read, such as a --set option.
struct ValueOrigin {
  std::string name;    ///< "--set water.spacing=0.02", for messages
  std::string folder;  ///< what relative paths in the value are relative to
};

class Value {
 public:
  using Array = std::vector<Value>;
  /// In the order of the file; keys are unique.
  using Object = std::vector<std::pair<std::string, Value>>;

  Value() = default;
  Value(const Value& other);
  Value(Value&&) = default;
  Value& operator=(const Value& other) { return *this = Value(other); }
  Value& operator=(Value&&) = default;
  ~Value() = default;
  Value(bool b) : data_(b) {}
  Value(int i) : data_(std::int64_t{i}) {}
  Value(std::int64_t i) : data_(i) {}
  /// A float is kept as the shortest decimal that gives it back, so 0.1f prints as 0.1.
  Value(float f);
  Value(double d) : data_(d) {}
  Value(const char* s) : data_(std::string(s)) {}
  Value(std::string_view s) : data_(std::string(s)) {}
  Value(std::string s) : data_(std::move(s)) {}
  Value(Array a) : data_(std::move(a)) {}
  Value(Object o) : data_(std::move(o)) {}

  static Value array() { return Value(Array{}); }
  static Value object() { return Value(Object{}); }

  bool isNull() const { return std::holds_alternative<std::monostate>(data_); }
  bool isBool() const { return std::holds_alternative<bool>(data_); }
  bool isInt() const { return std::holds_alternative<std::int64_t>(data_); }
  bool isNumber() const { return isInt() || std::holds_alternative<double>(data_); }
  bool isString() const { return std::holds_alternative<std::string>(data_); }
  bool isArray() const { return std::holds_alternative<Array>(data_); }
  bool isObject() const { return std::holds_alternative<Object>(data_); }

  // Each of these expects the matching kind (a WEIR_CHECK otherwise).
  bool asBool() const;
  std::int64_t asInt() const;
  double asDouble() const;  ///< of an integer too
  const std::string& asString() const;
  const Array& asArray() const;
  Array& asArray();
  const Object& asObject() const;
  Object& asObject();

  /// The member of an object, or null if it has none of that name (or this is not an object).
  const Value* find(std::string_view key) const;
  Value* find(std::string_view key);
  /// The member of an object, made if it is not there. A null value becomes an object first.
  Value& operator[](std::string_view key);
  void push(Value v) { asArray().push_back(std::move(v)); }

  /// "a number", "a string", "an object": for messages.
  std::string_view kindName() const;
  /// The value itself for a message, cut to a readable length.
  std::string brief() const;

  int line = 0;                               ///< from 1; 0 if it comes from no file
  int column = 0;                             ///< from 1
  std::shared_ptr<const ValueOrigin> origin;  ///< null if it comes from the file being read

  /// Equality of content; place and origin do not count. 1 and 1.0 are equal.
  bool operator==(const Value& other) const;

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, Array, Object> data_;
};

/// The name among `names` closest to `name` by edit distance, or "" if none is close enough to suggest.
std::string closestName(std::string_view name, const std::vector<std::string>& names);

/// "did you mean 'spacing'?", or "" if no name is close enough.
std::string didYouMean(std::string_view name, const std::vector<std::string>& names);

/// "a, b or c".
std::string joinNames(const std::vector<std::string>& names, std::string_view lastJoin = " or ");

}  // namespace weir
