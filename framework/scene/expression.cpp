#include "framework/scene/expression.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "framework/base/text.h"
#include "framework/base/value.h"

namespace weir {

namespace {

constexpr std::size_t kLongestExpression = 1000;
constexpr int kDeepestExpression = 32;

bool isLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

/// Exact where the result is 0, 1 or -1.
double sinOfDegrees(double degrees) {
  const double d = std::remainder(degrees, 360.0);  // exact
  if (d == 0 || std::abs(d) == 180) return 0;
  if (std::abs(d) == 90) return d > 0 ? 1 : -1;
  if (std::abs(d) == 30 || std::abs(d) == 150) return d > 0 ? 0.5 : -0.5;
  return std::sin(d * std::numbers::pi / 180);
}
double cosOfDegrees(double degrees) {
  const double d = std::abs(std::remainder(degrees, 360.0));
  if (d == 0) return 1;
  if (d == 180) return -1;
  if (d == 90) return 0;
  if (d == 60) return 0.5;
  if (d == 120) return -0.5;
  return std::cos(d * std::numbers::pi / 180);
}
double tanOfDegrees(double degrees) {
  const double d = std::remainder(degrees, 180.0);
  if (d == 0) return 0;
  if (std::abs(d) == 45) return d > 0 ? 1 : -1;
  if (std::abs(d) == 90) return std::numeric_limits<double>::infinity();
  return std::tan(d * std::numbers::pi / 180);
}

struct Function {
  std::string_view name;
  std::size_t arguments;  // 0: one or more
  double (*call)(const std::vector<double>&);
};

using Arguments = std::vector<double>;
constexpr Function kFunctions[] = {
    {"sqrt", 1, [](const Arguments& a) { return std::sqrt(a[0]); }},
    {"sin", 1, [](const Arguments& a) { return sinOfDegrees(a[0]); }},
    {"cos", 1, [](const Arguments& a) { return cosOfDegrees(a[0]); }},
    {"tan", 1, [](const Arguments& a) { return tanOfDegrees(a[0]); }},
    {"min", 0, [](const Arguments& a) { return *std::min_element(a.begin(), a.end()); }},
    {"max", 0, [](const Arguments& a) { return *std::max_element(a.begin(), a.end()); }},
    {"abs", 1, [](const Arguments& a) { return std::abs(a[0]); }},
    {"floor", 1, [](const Arguments& a) { return std::floor(a[0]); }},
    {"ceil", 1, [](const Arguments& a) { return std::ceil(a[0]); }},
    {"round", 1, [](const Arguments& a) { return std::round(a[0]); }},
};

const Function* findFunction(std::string_view name) {
  const auto* found = std::find_if(std::begin(kFunctions), std::end(kFunctions),
                                   [&](const Function& f) { return f.name == name; });
  return found == std::end(kFunctions) ? nullptr : found;
}

std::vector<std::string> functionNames() {
  std::vector<std::string> names;
  for (const Function& f : kFunctions) names.emplace_back(f.name);
  return names;
}

/// By recursive descent: sum, product, sign, power, operand, each binding tighter than the one before.
class Parser {
 public:
  Parser(std::string_view text, const ExpressionNames& names) : text_(text), names_(names) {}

  double value() {
    if (text_.size() > kLongestExpression)
      throw error(fmt::format("has {} characters", text_.size()),
                  fmt::format("at most {}", kLongestExpression));
    const double result = sum();
    if (!peek().empty()) throw unexpected("an operator or the end");
    return result;
  }

 private:
  Error error(const std::string& what, const std::string& allowed, const std::string& hint = {}) const {
    return sceneError("the expression " + inQuotes("=" + std::string(text_)) + " " + what, allowed, hint);
  }

  Error unexpected(const std::string& allowed) {
    const std::string_view rest = peek();
    if (rest.empty()) return error("ends too early", allowed);
    const std::size_t length = std::max<std::size_t>(1, utf8Length(rest, 0));
    return error(fmt::format("has {} at character {}", inQuotes(rest.substr(0, length)), at_ + 2), allowed);
  }

  /// What comes next; no space.
  std::string_view peek() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
    return text_.substr(at_);
  }

  bool take(char c) {
    const bool there = peek().starts_with(c);
    if (there) ++at_;
    return there;
  }

  double finite(double result, const std::string& of) const {
    if (std::isnan(result)) throw error("has no value: " + of + " is not a real number", "a finite number");
    if (!std::isfinite(result)) throw error("has no value: " + of + " is infinite", "a finite number");
    return result;
  }

  double sum() {
    double left = product();
    for (;;) {
      if (take('+'))
        left = finite(left + product(), "the sum");
      else if (take('-'))
        left = finite(left - product(), "the difference");
      else
        return left;
    }
  }

  double product() {
    double left = sign();
    for (;;) {
      if (take('*'))
        left = finite(left * sign(), "the product");
      else if (take('/'))
        left = quotient(left, sign());
      else
        return left;
    }
  }

  double quotient(double left, double right) const {
    if (right == 0) throw error("divides by zero", "a divisor that is not zero");
    return finite(left / right, "the quotient");
  }

  double sign() {
    const Deeper deeper(*this);
    return take('-') ? -sign() : power();
  }

  double power() {
    const double base = operand();
    if (!take('^')) return base;
    const double exponent = sign();
    if (base == 0 && exponent < 0) throw error("divides by zero", "a base that is not zero");
    return finite(std::pow(base, exponent), fmt::format("{}^{}", base, exponent));
  }

  double operand() {
    const std::string_view rest = peek();
    if (take('(')) return closed(sum());
    if (!rest.empty() && (isDigit(rest[0]) || rest[0] == '.')) return number(rest);
    if (!rest.empty() && isLetter(rest[0])) return named(word(rest));
    throw unexpected("a number, a name or '('");
  }

  double closed(double result) {
    if (!take(')')) throw unexpected("')' or an operator");
    return result;
  }

  double number(std::string_view rest) {
    double result = 0;
    const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), result);
    if (failure == std::errc::result_out_of_range)
      throw error("has a number that does not fit", "numbers up to 1.7e308");
    if (failure != std::errc()) throw unexpected("a number, a name or '('");
    at_ += static_cast<std::size_t>(end - rest.data());
    if (at_ < text_.size() && isLetter(text_[at_]))
      throw error("has " + inQuotes(word(text_.substr(at_))) + " right behind a number",
                  "an operator between",
                  "a product is written with '*'; units stand in strings of their own, such as \"5 cm\"");
    return result;
  }

  std::string word(std::string_view rest) {
    std::size_t length = 0;
    while (length < rest.size() && (isLetter(rest[length]) || isDigit(rest[length]))) ++length;
    at_ += length;
    return std::string(rest.substr(0, length));
  }

  double named(const std::string& name) {
    if (const std::optional<double> value = names_.valueOf(name)) return *value;
    if (name == "pi") return std::numbers::pi;
    if (const Function* function = findFunction(name)) return call(*function);
    std::vector<std::string> all = names_.all();
    all.emplace_back("pi");
    for (std::string& f : functionNames()) all.push_back(std::move(f));
    throw error("names " + inQuotes(name) + ", which there is not", joinNames(all),
                didYouMean(name, all).empty() ? "variables are given by \"let\" at the top of the scene"
                                              : didYouMean(name, all));
  }

  double call(const Function& function) {
    const std::string name(function.name);
    if (!take('(')) throw unexpected("'(' behind " + name);
    Arguments arguments{sum()};
    while (take(',')) arguments.push_back(sum());
    closed(0);
    if (function.arguments != 0 && arguments.size() != function.arguments)
      throw error(fmt::format("gives {} {} arguments", name, arguments.size()),
                  fmt::format("{} argument", function.arguments));
    return finite(function.call(arguments), fmt::format("{}({})", name, arguments[0]));
  }

  /// So that no text can exhaust the stack.
  struct Deeper {
    explicit Deeper(Parser& p) : parser(p) {
      if (++parser.depth_ > kDeepestExpression)
        throw parser.error("is nested too deeply", fmt::format("a depth of at most {}", kDeepestExpression));
    }
    ~Deeper() { --parser.depth_; }
    Deeper(const Deeper&) = delete;
    Deeper& operator=(const Deeper&) = delete;
    Parser& parser;
  };

  std::string_view text_;
  const ExpressionNames& names_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

bool isVariableName(std::string_view text) {
  const bool word = !text.empty() && text.size() <= 100 && isLetter(text[0]) &&
                    std::all_of(text.begin(), text.end(), [](char c) { return isLetter(c) || isDigit(c); });
  return word && text != "pi" && findFunction(text) == nullptr;
}

double evaluate(std::string_view expression, const ExpressionNames& names) {
  return Parser(expression, names).value();
}

}  // namespace weir
