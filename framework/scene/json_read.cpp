#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "framework/base/text.h"
#include "framework/scene/comments.h"
#include "framework/scene/json_text.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

using Json = nlohmann::json;

/// Builds a Value from the library's events. The library reports one event for each token that is no ',' or
/// ':', so JsonTokens, which walks the same tokens, knows where each of them stands.
class ValueBuilder final : public Json::json_sax_t {
 public:
  ValueBuilder(std::string_view text, const std::string& fileName) : tokens_(text), fileName_(fileName) {}

  bool null() override { return addWord(Value()); }
  bool boolean(bool b) override { return addWord(b); }
  bool number_integer(number_integer_t i) override { return addWord(Value(std::int64_t{i})); }
  bool number_unsigned(number_unsigned_t u) override {
    if (u > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
      failAt(tokens_.next(), tooLargeInteger(std::to_string(u)));
    return addWord(Value(static_cast<std::int64_t>(u)));
  }
  bool number_float(number_float_t d, const string_t& digits) override {
    if (digits.find_first_of(".eE") == string_t::npos) failAt(tokens_.next(), tooLargeInteger(digits));
    const std::string_view mantissa = std::string_view(digits).substr(0, digits.find_first_of("eE"));
    if (d == 0 && mantissa.find_first_of("123456789") != std::string_view::npos)
      failAt(tokens_.next(), sceneError("the number " + printable(digits) + " is too small",
                                        "0 or a magnitude of at least 4.9e-324"));
    return addWord(Value(double{d}));
  }
  bool string(string_t& s) override {
    place(Value(std::move(s)), tokens_.next());
    return true;
  }
  bool binary(binary_t&) override { return false; }  // the text format has none
  bool start_object(std::size_t) override { return open(Value::object()); }
  bool start_array(std::size_t) override { return open(Value::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    const TextPlace at = tokens_.next();
    const auto [first, added] = open_.back().lines.emplace(name, at.line);
    if (!added)
      failAt(at, sceneError("there are two members \"" + printable(name) + "\" in this object",
                            "every name once", fmt::format("the first one is in line {}", first->second)));
    open_.back().value->asObject().emplace_back(std::move(name), Value());
    open_.back().afterKey = true;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const Json::exception&) override {
    throw describeJsonMistake(tokens_, state(), opened(), fileName_);
  }

  Value finish() {
    tokens_.skipSpace();
    // The library takes a zero byte for the end of the text.
    if (!tokens_.rest().empty()) throw describeJsonMistake(tokens_, JsonState::kEnd, {}, fileName_);
    return std::move(root_);
  }

 private:
  struct Open {
    Value* value;  // stays where it is while it is open: only the innermost one grows
    TextPlace at;
    bool afterKey = false;
    std::unordered_map<std::string, int> lines;  // of the names in an object
  };

  static Error tooLargeInteger(const std::string& digits) {
    return sceneError("the integer " + printable(digits) + " is too large",
                      "integers from -9223372036854775808 to 9223372036854775807",
                      "write a number that need not be exact with an exponent, such as 1e20");
  }

  [[noreturn]] void failAt(const TextPlace& at, Error error) const {
    error.at({.file = fileName_, .line = at.line, .column = at.column});
    throw error;
  }

  Value& place(Value value, const TextPlace& at) {
    value.line = at.line;
    value.column = at.column;
    done_ = true;
    if (open_.empty()) return root_ = std::move(value);
    Open& parent = open_.back();
    if (parent.value->isArray()) {
      parent.value->push(std::move(value));
      return parent.value->asArray().back();
    }
    parent.afterKey = false;
    return parent.value->asObject().back().second = std::move(value);
  }

  /// A number or literal. The library takes 01 for a 0 with a 1 behind it, and truer for true and an r.
  bool addWord(Value value) {
    const JsonTokens before = tokens_;
    const TextPlace at = tokens_.next();
    if (!isJsonWord(tokens_.since(at))) throw describeJsonMistake(before, state(), opened(), fileName_);
    place(std::move(value), at);
    return true;
  }

  bool open(Value value) {
    const TextPlace at = tokens_.next();
    if (open_.size() == kDeepestNesting)
      failAt(at, sceneError(fmt::format("arrays and objects are nested more than {} deep", kDeepestNesting),
                            fmt::format("a depth of at most {}", kDeepestNesting)));
    Value& placed = place(std::move(value), at);
    open_.push_back({&placed, at, false, {}});
    return true;
  }

  bool close() {
    tokens_.next();
    open_.pop_back();
    return true;
  }

  TextPlace opened() const { return open_.empty() ? TextPlace{} : open_.back().at; }

  JsonState state() const {
    if (open_.empty()) return done_ ? JsonState::kEnd : JsonState::kDocument;
    const Open& inner = open_.back();
    if (inner.afterKey) return JsonState::kMember;
    if (inner.value->isArray())
      return inner.value->asArray().empty() ? JsonState::kFirstElement : JsonState::kNextElement;
    return inner.value->asObject().empty() ? JsonState::kFirstKey : JsonState::kNextKey;
  }

  JsonTokens tokens_;
  const std::string& fileName_;
  Value root_;
  bool done_ = false;  // whether the root has begun
  std::vector<Open> open_;
};

}  // namespace

Value parseJson(std::string_view text, const std::string& fileName) {
  ValueBuilder builder(text, fileName);
  Json::sax_parse(text.begin(), text.end(), &builder);
  return builder.finish();
}

Value parseScene(std::string_view text, const std::string& fileName) {
  return parseJson(withoutComments(text, fileName), fileName);
}

}  // namespace weir
