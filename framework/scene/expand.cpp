#include "framework/scene/expand.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "framework/base/text.h"
#include "framework/graph/units.h"
#include "framework/scene/comments.h"
#include "framework/scene/expression.h"

namespace weir {

namespace {

constexpr std::size_t kMaxVariables = 10000;
// Of variables that name each other, so that no file can exhaust the stack.
constexpr std::size_t kMaxChain = 50;
constexpr std::size_t kMaxRepeated = 200000;  // values that repetition makes, all together
constexpr int kMaxCopies = 100000;

bool isExpression(const Value& v) {
  return v.isString() && v.asString().starts_with('=') && !v.asString().starts_with("==");
}

/// An integer where it is whole, as JSON would write it.
Value numberOf(double d, const Value& at) {
  constexpr double kLargestExact = 9007199254740992.0;
  const bool whole = d == std::floor(d) && std::abs(d) <= kLargestExact && !(d == 0 && std::signbit(d));
  Value v = whole ? Value(static_cast<std::int64_t>(d)) : Value(d);
  v.line = at.line, v.column = at.column, v.origin = at.origin;
  return v;
}

/// The variables of "let", each evaluated when it is first asked for.
class Variables {
 public:
  Variables(const Value* let, const Place& place) : place_(place) {
    if (let == nullptr) return;
    if (!let->isObject()) throw place.error(*let, "found " + let->brief(), kForm);
    if (let->asObject().size() > kMaxVariables)
      throw place.error(*let, fmt::format("found {} variables", let->asObject().size()),
                        fmt::format("at most {}", kMaxVariables));
    for (const auto& [name, value] : let->asObject()) add(name, value);
  }

  void evaluateAll() {
    for (const std::string& name : names_) valueOf(name);
  }

  const std::vector<std::string>& names() const { return names_; }

  std::optional<double> find(const std::string& name) {
    return variables_.contains(name) ? std::optional(valueOf(name)) : std::nullopt;
  }

  double valueOf(const std::string& name) {
    Variable& variable = variables_.at(name);
    if (variable.isKnown) return variable.value;
    const Value& written = *variable.written;
    const Place here = place_ / name;
    checkChain(name, here, written);
    chain_.push_back(name);
    try {
      variable.value =
          evaluate(std::string_view(written.asString()).substr(1),
                   {[this](const std::string& other) { return find(other); }, [this] { return names_; }});
    } catch (Error& e) {
      throw e.at(here.of(written));
    }
    chain_.pop_back();
    variable.isKnown = true;
    return variable.value;
  }

 private:
  static constexpr const char* kForm =
      "an object of variables by name, each a number or an expression such as \"=20*4\"";

  struct Variable {
    const Value* written;
    double value = 0;
    bool isKnown = false;
  };

  void add(const std::string& name, const Value& value) {
    if (name == "note" && value.isString()) return;
    const Place here = place_ / name;
    if (!isVariableName(name))
      throw here.error(value, inQuotes(name) + " cannot name a variable",
                       "letters, digits and '_', beginning with a letter, and not a function or pi");
    if (!value.isNumber() && !isExpression(value))
      throw here.error(value, "found " + value.brief(), "a number or an expression such as \"=20*4\"");
    names_.push_back(name);
    variables_[name] = {&value, value.isNumber() ? value.asDouble() : 0, value.isNumber()};
  }

  void checkChain(const std::string& name, const Place& here, const Value& written) const {
    const auto first = std::find(chain_.begin(), chain_.end(), name);
    if (first != chain_.end())
      throw here.error(written,
                       fmt::format("the variables depend on each other: {} -> {}",
                                   fmt::join(first, chain_.end(), " -> "), name),
                       "variables without a cycle");
    if (chain_.size() == kMaxChain)
      throw here.error(written, "the chain of variables that name each other is too long",
                       fmt::format("at most {}", kMaxChain));
  }

  Place place_;
  std::vector<std::string> names_;  // in the order of the file
  std::unordered_map<std::string, Variable> variables_;
  std::vector<std::string> chain_;  // that are being evaluated
};

class Expander {
 public:
  explicit Expander(Variables& variables) : variables_(variables) {}

  Value value(const Value& v, const Place& place) {
    if (!indices_.empty() && ++made_ > kMaxRepeated)
      throw place.error(v, "repetition makes too many values", fmt::format("at most {}", kMaxRepeated));
    if (v.isString()) return text(v, place);
    if (v.isArray()) return list(v, place);
    if (v.isObject()) return object(v, place);
    return v;
  }

  Value nodes(const Value& v, const Place& place) {
    if (!v.isObject()) return v;
    Value out = likeIt(v, Value::object());
    std::unordered_set<std::string> names;
    const auto add = [&](std::string name, Value node, const Place& here) {
      if (!names.insert(name).second)
        throw here.error(node, "there are two nodes " + inQuotes(name), "every name once",
                         "the name of a repeated node has the index in braces, such as \"paddle_{i}\"");
      out.asObject().emplace_back(std::move(name), std::move(node));
    };
    for (const auto& [name, node] : v.asObject()) {
      const Place here = place / name;
      if (isNote(name, node)) continue;
      if (isRepeat(node))
        repeat(node, here, "node", [&](const Value& each, const Place& at) {
          Value made = value(each, at);
          add(filled(name, node, here), std::move(made), here);
        });
      else
        add(name, value(node, here), here);
    }
    return out;
  }

 private:
  static bool isNote(const std::string& name, const Value& v) { return name == "note" && v.isString(); }
  static bool isRepeat(const Value& v) { return v.find("repeat") != nullptr && v.find("type") == nullptr; }

  static Value likeIt(const Value& v, Value out) {
    out.line = v.line, out.column = v.column, out.origin = v.origin;
    return out;
  }

  Value list(const Value& v, const Place& place) {
    Value out = likeIt(v, Value::array());
    for (std::size_t i = 0; i < v.asArray().size(); ++i) {
      const Value& item = v.asArray()[i];
      const Place here = place / i;
      if (isRepeat(item) && item.find("item") != nullptr)
        repeat(item, here, "item", [&](const Value& each, const Place& at) { out.push(value(each, at)); });
      else
        out.push(value(item, here));
    }
    return out;
  }

  Value object(const Value& v, const Place& place) {
    Value out = likeIt(v, Value::object());
    for (const auto& [name, member] : v.asObject())
      if (!isNote(name, member)) out.asObject().emplace_back(name, value(member, place / name));
    return out;
  }

  Value text(const Value& v, const Place& place) {
    const std::string& s = v.asString();
    if (s.starts_with("==")) return likeIt(v, Value(s.substr(1)));
    if (isExpression(v)) return numberOf(calculated(std::string_view(s).substr(1), v, place), v);
    return indices_.empty() ? v : likeIt(v, Value(filled(s, v, place)));
  }

  double calculated(std::string_view expression, const Value& v, const Place& place) {
    try {
      return evaluate(expression,
                      {[this](const std::string& name) { return find(name); }, [this] { return names(); }});
    } catch (Error& e) {
      throw e.at(place.of(v));
    }
  }

  std::optional<double> find(const std::string& name) {
    for (auto index = indices_.rbegin(); index != indices_.rend(); ++index)
      if (index->first == name) return index->second;
    return variables_.find(name);
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all = variables_.names();
    for (const auto& [name, index] : indices_) all.push_back(name);
    return all;
  }

  /// With what stands in braces replaced by its value, which is whole.
  std::string filled(const std::string& s, const Value& v, const Place& place) {
    std::string out;
    for (std::size_t at = 0; at < s.size();) {
      const std::size_t open = s.find('{', at), close = s.find('}', open);
      if (open == std::string::npos || close == std::string::npos) return out + s.substr(at);
      const double index = calculated(std::string_view(s).substr(open + 1, close - open - 1), v, place);
      if (index != std::floor(index) || std::abs(index) > 1e15)
        throw place.error(v, fmt::format("{} is {}", inQuotes(s.substr(open, close - open + 1)), index),
                          "a whole number in braces");
      out += s.substr(at, open - at) + fmt::format("{}", static_cast<std::int64_t>(index));
      at = close + 1;
    }
    return out;
  }

  template <class Each>
  void repeat(const Value& v, const Place& place, const char* what, const Each& each) {
    const std::vector<std::string> known{"repeat", "as", what, "note"};
    for (const auto& [name, member] : v.asObject())
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw(place / name)
            .error(member, "a repetition has no member " + inQuotes(name), joinNames(known),
                   didYouMean(name, known));
    const Value* body = v.find(what);
    if (body == nullptr)
      throw place.error(v, fmt::format("the repetition has no \"{}\"", what),
                        fmt::format("{{\"repeat\": 5, \"as\": \"i\", \"{}\": ...}}", what));
    const std::string name = indexName(v, place);
    const int count = countOf(*v.find("repeat"), place / "repeat");
    for (int i = 0; i < count; ++i) {
      indices_.emplace_back(name, i);
      each(*body, place / what);
      indices_.pop_back();
    }
  }

  std::string indexName(const Value& v, const Place& place) const {
    const Value* as = v.find("as");
    if (as == nullptr) return "i";
    if (!as->isString() || !isVariableName(as->asString()))
      throw(place / "as")
          .error(*as, "found " + as->brief() + " as the name of the index",
                 "letters, digits and '_', beginning with a letter");
    return as->asString();
  }

  int countOf(const Value& v, const Place& place) {
    const Value count = value(v, place);
    const bool whole = count.isNumber() && count.asDouble() == std::floor(count.asDouble());
    if (!whole || count.asDouble() < 0 || count.asDouble() > kMaxCopies)
      throw place.error(v, "found " + (isExpression(v) ? v.brief() + ", which is " : "") + count.brief(),
                        fmt::format("a whole number of copies from 0 to {}", kMaxCopies));
    return static_cast<int>(count.asDouble());
  }

  Variables& variables_;
  std::vector<std::pair<std::string, double>> indices_;
  std::size_t made_ = 0;
};

/// Members of a scene that are taken as they stand.
bool isVerbatim(const std::string& name) {
  static const std::vector<std::string> kNames{"weir", "title", "$schema", "plugins", "layout"};
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

void setVariables(Value& root, const Place& place, const std::vector<Override>& overrides) {
  for (const Override& o : overrides) {
    if (!setsVariable(o)) continue;
    Value* let = root.find("let");
    std::vector<std::string> names;
    if (let != nullptr && let->isObject())
      for (const auto& [name, value] : let->asObject()) names.push_back(printable(name));
    Value* variable = o.path.size() == 2 && let != nullptr ? let->find(o.path[1]) : nullptr;
    if (variable == nullptr)
      throw place.error(
          o.value, "the scene has no variable " + inQuotes(fmt::format("{}", fmt::join(o.path, "."))),
          names.empty() ? "nothing: it has no \"let\"" : "let.NAME with NAME one of " + joinNames(names),
          didYouMean(o.path.back(), names));
    *variable = o.value;
  }
}

void look(const Value& v, WrittenForm& form) {
  if (v.isArray())
    for (const Value& item : v.asArray()) look(item, form);
  if (v.isString() && (v.asString().starts_with('=') || isQuantity(v.asString()))) form.shorthand = true;
  if (!v.isObject()) return;
  for (const auto& [name, member] : v.asObject()) {
    if (name == "note" && member.isString())
      form.notes = true;
    else
      look(member, form);
    if (name == "$include" || name == "repeat") form.shorthand = true;
  }
}

}  // namespace

WrittenForm writtenForm(std::string_view text, const Value& root) {
  WrittenForm form;
  form.comments = withoutComments(text, {}) != text;
  if (!root.isObject()) return form;
  for (const auto& [name, member] : root.asObject()) {
    if (name == "let" || name == "$include") form.shorthand = true;
    if (name == "note") form.notes = true;
    if (!isVerbatim(name)) look(member, form);
  }
  return form;
}

bool setsVariable(const Override& o) {
  return o.path.front() == "let";
}

ExpandedScene expandScene(const Value& written, const Place& place, const std::vector<Override>& overrides) {
  if (!written.isObject()) return {written, {}};  // building the scene reports it
  Value root = withIncludes(written, place);
  setVariables(root, place, overrides);
  Variables variables(std::as_const(root).find("let"), place / "let");
  variables.evaluateAll();
  Expander expander(variables);
  ExpandedScene expanded{Value::object(), {}};
  Value& plain = expanded.plain;
  plain.line = root.line, plain.column = root.column, plain.origin = root.origin;
  for (const auto& [name, member] : root.asObject()) {
    if (name == "let" || (name == "note" && member.isString())) continue;
    const Place here = place / name;
    plain.asObject().emplace_back(name, isVerbatim(name)  ? member
                                        : name == "nodes" ? expander.nodes(member, here)
                                                          : expander.value(member, here));
  }
  for (const Override& o : overrides) {
    if (setsVariable(o)) continue;
    expanded.overrides.push_back(o);
    if (o.path.front() != "title") expanded.overrides.back().value = expander.value(o.value, {});
  }
  return expanded;
}

}  // namespace weir
