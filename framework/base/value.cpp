#include "framework/base/value.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numeric>

#include "framework/base/check.h"
#include "framework/base/text.h"

namespace weir {

// GCC 12 at -O3 jumps astray where a copy within std::variant's constructor of copies throws, as
// std::bad_alloc does. What is only moved into the variant cannot throw there.
Value::Value(const Value& other) : line(other.line), column(other.column), origin(other.origin) {
  std::visit(
      [&](const auto& content) {
        auto copy = content;
        data_ = std::move(copy);
      },
      other.data_);
}

Value::Value(float f) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, f).ptr;
  double d = 0;
  std::from_chars(text, end, d);
  data_ = d;
}

bool Value::asBool() const {
  WEIR_CHECK(isBool());
  return std::get<bool>(data_);
}
std::int64_t Value::asInt() const {
  WEIR_CHECK(isInt());
  return std::get<std::int64_t>(data_);
}
double Value::asDouble() const {
  WEIR_CHECK(isNumber());
  return isInt() ? double(std::get<std::int64_t>(data_)) : std::get<double>(data_);
}
const std::string& Value::asString() const {
  WEIR_CHECK(isString());
  return std::get<std::string>(data_);
}
const Value::Array& Value::asArray() const {
  WEIR_CHECK(isArray());
  return std::get<Array>(data_);
}
Value::Array& Value::asArray() {
  WEIR_CHECK(isArray());
  return std::get<Array>(data_);
}
const Value::Object& Value::asObject() const {
  WEIR_CHECK(isObject());
  return std::get<Object>(data_);
}
Value::Object& Value::asObject() {
  WEIR_CHECK(isObject());
  return std::get<Object>(data_);
}

const Value* Value::find(std::string_view key) const {
  if (!isObject()) return nullptr;
  for (const auto& [name, value] : std::get<Object>(data_))
    if (name == key) return &value;
  return nullptr;
}
Value* Value::find(std::string_view key) {
  return const_cast<Value*>(static_cast<const Value*>(this)->find(key));
}
Value& Value::operator[](std::string_view key) {
  if (isNull()) data_ = Object{};
  if (Value* found = find(key)) return *found;
  return asObject().emplace_back(std::string(key), Value{}).second;
}

std::string_view Value::kindName() const {
  constexpr std::string_view kNames[] = {"null",     "a boolean", "an integer", "a number",
                                         "a string", "an array",  "an object"};
  return kNames[data_.index()];
}

std::string Value::brief() const {
  constexpr std::size_t kLongest = 60;
  if (isNull()) return "null";
  if (isBool()) return asBool() ? "true" : "false";
  if (isInt()) return std::to_string(asInt());
  if (isNumber()) return fmt::format("{}", asDouble());
  if (isObject())
    return fmt::format("an object of {} member{}", asObject().size(), asObject().size() == 1 ? "" : "s");
  if (isString()) return '"' + printable(asString(), kLongest) + '"';
  std::string text = "[";
  for (const Value& v : asArray()) {
    if (text.size() > kLongest) break;
    text += (text.size() > 1 ? ", " : "") + v.brief();
  }
  return printable(text + "]", kLongest);
}

bool Value::operator==(const Value& other) const {
  if (isNumber() && other.isNumber() && !(isInt() && other.isInt())) return asDouble() == other.asDouble();
  return data_ == other.data_;
}

namespace {

std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = std::tolower(static_cast<unsigned char>(a[i - 1])) ==
                        std::tolower(static_cast<unsigned char>(b[j - 1]));
      const std::size_t replace = diagonal + (same ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replace});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string closestName(std::string_view name, const std::vector<std::string>& names) {
  constexpr std::size_t kLongestCompared = 200;
  if (name.size() > kLongestCompared) return {};
  std::string best;
  std::size_t bestDistance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : names) {
    const std::size_t distance = editDistance(name, candidate);
    if (distance < bestDistance) bestDistance = distance, best = candidate;
  }
  return best;
}

std::string didYouMean(std::string_view name, const std::vector<std::string>& names) {
  const std::string nearest = closestName(name, names);
  return nearest.empty() ? std::string() : "did you mean " + inQuotes(nearest) + "?";
}

std::string joinNames(const std::vector<std::string>& names, std::string_view lastJoin) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? std::string(lastJoin) : ", ";
    text += names[i];
  }
  return text;
}

}  // namespace weir
