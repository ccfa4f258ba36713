// The points of a sweep: which parameters have which values in each run.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace weir::app {

/// More are refused.
inline constexpr std::size_t kMaxPoints = 100'000;

/// A parameter and its value, as the option --set of `weir run` takes them.
struct Setting {
  std::string name, value;
  friend bool operator==(const Setting&, const Setting&) = default;
};

/// What one run is made with.
using Point = std::vector<Setting>;
/// The points that one option asks for, each with the same parameters.
using PointList = std::vector<Point>;

/// From "NAME=VALUE,VALUE,…": a point for each value. Commas within brackets, braces or double quotes part
/// nothing. Throws a usage Error.
PointList listedPoints(std::string_view text);

/// From a table (framework/base/table_text.h) whose header names parameters: a point for each line. Throws an
/// io Error with line and column.
PointList tablePoints(const std::filesystem::path& file);

/// Each point of a list with each of the next one, those of the last list changing fastest. No list is one
/// empty point. Throws a usage Error if two lists set the same parameter, if a point is there twice, or if
/// there are more than kMaxPoints.
PointList productOf(const std::vector<PointList>& lists);

/// "water.spacing=0.02,jet.speed=1": the name of a point's folder, of letters, digits and ".,=_+-" alone.
/// What was changed for that, or cut to 120 bytes, ends in "-" and eight digits of a hash, so that no two
/// points have the same.
std::string folderNameOf(const Point& point);

/// "water.spacing = 0.02, jet.speed = 1", for messages.
std::string describe(const Point& point);

}  // namespace weir::app
