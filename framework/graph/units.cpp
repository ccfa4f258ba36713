#include "framework/graph/units.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>

#include "framework/base/text.h"
#include "framework/graph/param_types.h"

namespace weir {

namespace {

/// Powers of metre, kilogram, second, radian, pixel, spacing and diameter.
using Dimension = std::array<int, 7>;

/// `numerator / denominator` of the base units. Two numbers, so that 5 cm is 5 / 100 m, rounded once.
struct Unit {
  Dimension dimension{};
  double numerator = 1, denominator = 1;
};

struct Symbol {
  std::string_view name;
  Unit unit;
};

constexpr double kPi = std::numbers::pi;
constexpr Dimension kNone{}, kLength{1}, kMass{0, 1}, kTime{0, 0, 1}, kAngle{0, 0, 0, 1},
    kFrequency{0, 0, -1}, kForce{1, 1, -2}, kPressure{-1, 1, -2}, kEnergy{2, 1, -2}, kVolume{3};

/// These may have a prefix.
constexpr Symbol kPrefixed[] = {
    {"m", {kLength}},
    {"g", {kMass, 1, 1000}},
    {"s", {kTime}},
    {"N", {kForce}},
    {"Pa", {kPressure}},
    {"J", {kEnergy}},
    {"W", {{2, 1, -3}}},
    {"Hz", {kFrequency}},
    {"l", {kVolume, 1, 1000}},
    {"L", {kVolume, 1, 1000}},
    {"bar", {kPressure, 100000, 1}},
};
constexpr Symbol kWhole[] = {
    {"min", {kTime, 60, 1}},
    {"h", {kTime, 3600, 1}},
    {"t", {kMass, 1000, 1}},
    {"rad", {kAngle}},
    {"deg", {kAngle, kPi, 180}},
    {"degree", {kAngle, kPi, 180}},
    {"degrees", {kAngle, kPi, 180}},
    {"°", {kAngle, kPi, 180}},
    {"rev", {kAngle, 2 * kPi, 1}},
    {"rpm", {{0, 0, -1, 1}, kPi, 30}},
    {"px", {{0, 0, 0, 0, 1}}},
    {"pixel", {{0, 0, 0, 0, 1}}},
    {"pixels", {{0, 0, 0, 0, 1}}},
    {"spacing", {{0, 0, 0, 0, 0, 1}}},
    {"spacings", {{0, 0, 0, 0, 0, 1}}},
    {"d", {{0, 0, 0, 0, 0, 0, 1}}},
    {"1", {kNone}},
};
constexpr std::pair<std::string_view, Unit> kPrefixes[] = {
    {"n", {kNone, 1, 1e9}}, {"u", {kNone, 1, 1e6}}, {"µ", {kNone, 1, 1e6}}, {"μ", {kNone, 1, 1e6}},
    {"m", {kNone, 1, 1e3}}, {"c", {kNone, 1, 1e2}}, {"d", {kNone, 1, 1e1}}, {"h", {kNone, 1e2, 1}},
    {"k", {kNone, 1e3, 1}}, {"M", {kNone, 1e6, 1}}, {"G", {kNone, 1e9, 1}},
};
/// What messages offer, where the dimension is that of the parameter.
constexpr std::string_view kOffered[] = {
    "m",     "cm",  "mm",    "km",     "s",      "ms",    "min",   "h",        "kg",   "g",
    "deg",   "rad", "m/s",   "cm/s",   "km/h",   "m/s^2", "rad/s", "deg/s",    "rpm",  "1/s",
    "Hz",    "1/m", "1/cm",  "kg/m^3", "g/cm^3", "kg/l",  "Pa",    "kPa",      "bar",  "Pa s",
    "mPa s", "N",   "mN",    "N/m",    "mN/m",   "J",     "mJ",    "m^2",      "cm^2", "m^3",
    "l",     "ml",  "m^2/s", "mm^2/s", "m^3/s",  "l/s",   "px",    "spacings", "1/kg", "d",
};

/// a * b^power, the fraction in lowest terms where it is of whole numbers.
Unit times(Unit a, Unit b, int power) {
  if (power < 0) std::swap(b.numerator, b.denominator);
  for (int i = 0; i < std::abs(power); ++i) a.numerator *= b.numerator, a.denominator *= b.denominator;
  for (std::size_t i = 0; i < a.dimension.size(); ++i) a.dimension[i] += power * b.dimension[i];
  constexpr double kExact = 9007199254740992.0;
  const auto whole = [](double x) { return x == std::floor(x) && x >= 1 && x <= kExact; };
  if (a.numerator == a.denominator) {
    a.numerator = a.denominator = 1;
  } else if (whole(a.numerator) && whole(a.denominator)) {
    const auto common = static_cast<double>(
        std::gcd(static_cast<std::int64_t>(a.numerator), static_cast<std::int64_t>(a.denominator)));
    a.numerator /= common, a.denominator /= common;
  }
  return a;
}

std::optional<Unit> findSymbol(std::string_view name) {
  for (const Symbol& symbol : kWhole)
    if (symbol.name == name) return symbol.unit;
  for (const Symbol& symbol : kPrefixed) {
    if (symbol.name == name) return symbol.unit;
    if (!name.ends_with(symbol.name)) continue;
    for (const auto& [prefix, factor] : kPrefixes)
      if (name.size() == prefix.size() + symbol.name.size() && name.starts_with(prefix))
        return times(symbol.unit, factor, 1);
  }
  return std::nullopt;
}

/// A factor with its power: "cm^3", "s^-2".
std::optional<Unit> parseFactor(std::string_view text) {
  const std::size_t caret = text.find('^');
  int power = 1;
  if (caret != std::string_view::npos) {
    const char *begin = text.data() + caret + 1, *end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(begin, end, power);
    if (error != std::errc() || rest != end || std::abs(power) > 9) return std::nullopt;
  }
  const std::optional<Unit> symbol = findSymbol(text.substr(0, caret));
  return symbol ? std::optional(times({}, *symbol, power)) : std::nullopt;
}

/// Factors between which there is a space, '*' or '/', which only divides by the factor behind it.
std::optional<Unit> parseUnit(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  if (text.empty() || text.size() > kLongest) return std::nullopt;
  Unit unit;
  int sign = 1;
  for (;;) {
    const std::size_t end = text.find_first_of(" */");
    const std::optional<Unit> factor = parseFactor(text.substr(0, end));
    if (!factor) return std::nullopt;
    unit = times(unit, *factor, sign);
    if (end == std::string_view::npos) return unit;
    sign = text[end] == '/' ? -1 : 1;
    text.remove_prefix(end + 1);
  }
}

struct Quantity {
  double number = 0;
  std::string_view digits;  // of the number
  std::string_view unit;    // as written; not empty
};

std::optional<Quantity> split(std::string_view text) {
  Quantity q;
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  const std::string_view bare = digits.starts_with('-') ? digits.substr(1) : digits;
  if (bare.empty() || (bare[0] != '.' && (bare[0] < '0' || bare[0] > '9'))) return std::nullopt;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), q.number);
  if (error != std::errc()) return std::nullopt;
  q.digits = digits.substr(0, static_cast<std::size_t>(end - digits.data()));
  q.unit = digits.substr(q.digits.size());
  while (q.unit.starts_with(' ')) q.unit.remove_prefix(1);
  while (q.unit.ends_with(' ')) q.unit.remove_suffix(1);
  return q.unit.empty() ? std::nullopt : std::optional(q);
}

/// Rounded once where the factor is a power of ten.
double scaled(const Quantity& q, const Unit& factor) {
  const double ratio = factor.denominator == 1 ? factor.numerator : factor.denominator;
  const bool single = factor.numerator == 1 || factor.denominator == 1;
  const double power = std::round(std::log10(ratio));
  if (!single || power <= 0 || power > 15 || std::pow(10.0, power) != ratio)
    return q.number * factor.numerator / factor.denominator;
  const std::size_t e = q.digits.find_first_of("eE");
  int exponent = 0;
  if (e != std::string_view::npos) {
    std::string_view tail = q.digits.substr(e + 1);
    if (tail.starts_with('+')) tail.remove_prefix(1);
    std::from_chars(tail.data(), tail.data() + tail.size(), exponent);
  }
  exponent += static_cast<int>(factor.denominator == 1 ? power : -power);
  const std::string text = fmt::format("{}e{}", q.digits.substr(0, e), exponent);
  double result = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result);
  return error == std::errc() ? result : q.number * factor.numerator / factor.denominator;
}

std::vector<std::string> unitsLike(const Dimension& dimension) {
  std::vector<std::string> units;
  for (const std::string_view name : kOffered)
    if (parseUnit(name)->dimension == dimension) units.emplace_back(name);
  return units;
}

std::string allowedUnits(const ParamSpec& spec, const std::optional<Unit>& own) {
  const std::string number = describeRange("a number", spec);
  if (!own) return number;
  const std::vector<std::string> units = unitsLike(own->dimension);
  return units.empty() ? number : number + ", or a text with a unit: " + joinNames(units);
}

}  // namespace

bool isQuantity(std::string_view text) {
  const std::optional<Quantity> q = split(text);
  return q && parseUnit(q->unit);
}

std::optional<double> quantityIn(const ParamSpec& spec, const Value& v, const Place& place) {
  const std::optional<Quantity> q = split(v.asString());
  if (!q) return std::nullopt;
  const std::optional<Unit> own = parseUnit(spec.unit);
  const std::optional<Unit> given = parseUnit(q->unit);
  if (spec.unit.empty())
    throw place.error(v, "found " + v.brief() + ", but this parameter has no unit", allowedUnits(spec, own));
  if (!given) {
    std::vector<std::string> all;
    if (own) all = unitsLike(own->dimension);
    throw place.error(v, "found " + v.brief() + ": the unit " + inQuotes(q->unit) + " is not known",
                      allowedUnits(spec, own), didYouMean(q->unit, all));
  }
  if (!own || own->dimension != given->dimension)
    throw place.error(v, fmt::format("found {}, which cannot be converted to {}", v.brief(), spec.unit),
                      allowedUnits(spec, own));
  return scaled(*q, times(*given, *own, -1));
}

}  // namespace weir
