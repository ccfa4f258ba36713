// Points that fill ranges of parameters evenly, for studies of more parameters than a grid can have.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "apps/weir/sweep/points.h"

namespace weir::app {

/// From min to max, in equal parts or, if `logarithmic`, in equal ratios.
struct Range {
  std::string name;
  double min = 0, max = 1;
  bool logarithmic = false;

  /// From "NAME=MIN:MAX" or "NAME=MIN:MAX:log". Throws a usage Error.
  static Range parse(std::string_view text);
};

enum class SampleKind { kSobol, kLatinHypercube };

/// How many points of which kind.
struct Sampling {
  SampleKind kind = SampleKind::kSobol;
  std::size_t count = 0;

  /// From "sobol:64" or "latin:64". Throws a usage Error.
  static Sampling parse(std::string_view text);
};

/// Points of the unit cube, [0, 1) in each dimension.
///
/// Sobol: the first points of his sequence (Bratley and Fox, Algorithm 659, ACM TOMS 14, 1988), the origin
/// included; more of them begin with the same. `seed` plays no part. At least 1 dimension; throws a usage
/// Error for more than the sequence is known for, or if Weir was built without it.
///
/// Latin hypercube (McKay, Beckman, Conover, Technometrics 21, 1979): in each dimension, one point at random
/// in each of `count` equal parts. `seed` decides all.
std::vector<std::vector<double>> unitSamples(const Sampling& sampling, std::size_t dimensions,
                                             std::uint64_t seed);

/// The same in the ranges, as floats. Throws a usage Error if there are none.
PointList sampledPoints(const Sampling& sampling, const std::vector<Range>& ranges, std::uint64_t seed);

}  // namespace weir::app
