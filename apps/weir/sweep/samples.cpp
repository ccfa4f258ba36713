#include "apps/weir/sweep/samples.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numeric>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/random.h"
#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

#ifdef WEIR_HAS_SOBOL
#include <boost/random/sobol.hpp>
#endif

namespace weir::app {

namespace {

using Samples = std::vector<std::vector<double>>;

template <class T>
bool parseAll(std::string_view text, T& number) {
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && rest == end;
}

/// What stands before the separator, which is taken off with it; all of the text where there is none.
std::string_view takeUntil(std::string_view& text, char separator) {
  const std::size_t at = text.find(separator);
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
  return part;
}

#ifdef WEIR_HAS_SOBOL

Samples sobol(std::size_t count, std::size_t dimensions) {
  constexpr std::size_t kMaxDimensions = boost::random::default_sobol_table::max_dimension;
  if (dimensions > kMaxDimensions)
    throw usageError("there are too many ranges for Sobol's sequence",
                     fmt::format("{} at most", kMaxDimensions), "a Latin hypercube takes any number");
  boost::random::sobol sequence(dimensions);  // which leaves the origin out
  Samples samples(count, std::vector<double>(dimensions));
  for (std::size_t i = 1; i < count; ++i)
    for (double& x : samples[i]) x = static_cast<double>(sequence() >> 11) * 0x1p-53;
  return samples;
}

#else

Samples sobol(std::size_t, std::size_t) {
  throw usageError("this Weir was built without Sobol's sequence", "latin:N",
                   "install Boost 1.74 or later, and build again");
}

#endif

/// Numbers in [0, 1) that a seed decides.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : seed_(seed) {}
  double operator()() { return 0.5 * (noise(seed_, index_++) + 1); }

 private:
  std::uint64_t seed_, index_ = 0;
};

/// 0 to count − 1 in random order (Fisher and Yates).
std::vector<std::size_t> permutation(std::size_t count, Uniform& random) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(random() * static_cast<double>(i))]);
  return order;
}

Samples latinHypercube(std::size_t count, std::size_t dimensions, std::uint64_t seed) {
  Uniform random(seed);
  Samples samples(count, std::vector<double>(dimensions));
  for (std::size_t d = 0; d < dimensions; ++d) {
    const std::vector<std::size_t> cells = permutation(count, random);
    for (std::size_t i = 0; i < count; ++i)
      samples[i][d] = (static_cast<double>(cells[i]) + random()) / static_cast<double>(count);
  }
  return samples;
}

/// As a float: more digits mean nothing to parameters, and names of folders stay short.
std::string valueIn(const Range& range, double x) {
  const double value = range.logarithmic ? range.min * std::pow(range.max / range.min, x)
                                         : range.min + x * (range.max - range.min);
  return fmt::format("{}", static_cast<float>(value));
}

}  // namespace

Range Range::parse(std::string_view text) {
  const auto refuse = [&](std::string_view why) {
    return usageError(fmt::format("--range {}: {}", printable(text, 200), why),
                      "NAME=MIN:MAX, or NAME=MIN:MAX:log for equal ratios, with MIN below MAX");
  };
  Range range;
  std::string_view rest = text;
  range.name = takeUntil(rest, '=');
  (void)parseOverride(range.name + "=0");
  const std::string_view min = takeUntil(rest, ':'), max = takeUntil(rest, ':');
  if (!parseAll(min, range.min) || !parseAll(max, range.max)) throw refuse("there are no two numbers");
  if (!std::isfinite(range.min) || !std::isfinite(range.max) || range.min >= range.max)
    throw refuse("this is no range");
  if (!rest.empty() && rest != "log") throw refuse("what stands behind it is not known");
  range.logarithmic = !rest.empty();
  if (range.logarithmic && range.min <= 0) throw refuse("equal ratios need a MIN above 0");
  return range;
}

Sampling Sampling::parse(std::string_view text) {
  const auto refuse = [&] {
    return usageError("--sample " + printable(text) + " is not known",
                      fmt::format("sobol:N or latin:N with 1 to {} points, such as sobol:64", kMaxPoints));
  };
  Sampling sampling;
  std::string_view rest = text;
  const std::string_view kind = takeUntil(rest, ':');
  if (kind != "sobol" && kind != "latin") throw refuse();
  sampling.kind = kind == "sobol" ? SampleKind::kSobol : SampleKind::kLatinHypercube;
  if (!parseAll(rest, sampling.count) || sampling.count == 0 || sampling.count > kMaxPoints) throw refuse();
  return sampling;
}

Samples unitSamples(const Sampling& sampling, std::size_t dimensions, std::uint64_t seed) {
  return sampling.kind == SampleKind::kSobol ? sobol(sampling.count, dimensions)
                                             : latinHypercube(sampling.count, dimensions, seed);
}

PointList sampledPoints(const Sampling& sampling, const std::vector<Range>& ranges, std::uint64_t seed) {
  if (ranges.empty()) throw usageError("--sample has no range to fill", "one --range NAME=MIN:MAX or more");
  PointList points;
  for (const std::vector<double>& sample : unitSamples(sampling, ranges.size(), seed)) {
    Point& point = points.emplace_back();
    for (std::size_t d = 0; d < ranges.size(); ++d)
      point.push_back({ranges[d].name, valueIn(ranges[d], sample[d])});
  }
  return points;
}

}  // namespace weir::app
