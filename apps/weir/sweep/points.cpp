#include "apps/weir/sweep/points.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "framework/base/error.h"
#include "framework/base/random.h"
#include "framework/base/table_text.h"
#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir::app {

namespace {

constexpr std::size_t kLargestTable = std::size_t{64} << 20;
constexpr const char* kForm = "NAME=VALUE,VALUE,… such as water.spacing=0.02,0.01";

/// At the commas that are not within brackets, braces or quotes.
std::vector<std::string> partsOf(std::string_view text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (!quoted) depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (c == ',' && depth == 0 && !quoted) {
      parts.emplace_back();
      continue;
    }
    parts.back() += c;
    if (quoted && c == '\\' && i + 1 < text.size()) parts.back() += text[++i];
  }
  return parts;
}

/// Throws a usage Error if --set would not take it.
void checkSetting(const Setting& setting) {
  (void)parseOverride(setting.name + "=" + setting.value);
}

Setting settingOf(const std::string& name, const std::string& value) {
  if (value.find_first_not_of(" \t") == std::string::npos)
    throw usageError(fmt::format("--set {}: a value is empty", printable(name, 200)), kForm);
  Setting setting{name, value};
  checkSetting(setting);
  return setting;
}

std::vector<std::string> columnsOf(const TableLines& lines) {
  std::vector<std::string> names;
  TableFields fields(lines.line(), lines.number());
  while (fields.next()) {
    const std::string name = fields.text();
    if (std::find(names.begin(), names.end(), name) != names.end())
      throw fields.error("the parameter " + inQuotes(name) + " has two columns", "one column for each");
    try {
      checkSetting({name, "0"});
    } catch (const Error& e) {
      throw fields.error("the column " + inQuotes(name) + " is no parameter", e.allowed());
    }
    names.push_back(name);
  }
  return names;
}

Setting settingOf(const std::string& name, const TableFields& field) {
  Setting setting{name, field.text()};
  if (setting.value.empty()) throw field.error("the field of " + inQuotes(name) + " is empty", "a value");
  try {
    checkSetting(setting);
  } catch (const Error& e) {
    throw field.error(e.message(), e.allowed());
  }
  return setting;
}

Point pointOf(const TableLines& lines, const std::vector<std::string>& columns) {
  const std::string wanted = fmt::format("{} fields, as in the header", columns.size());
  Point point;
  TableFields fields(lines.line(), lines.number());
  while (fields.next()) {
    if (point.size() == columns.size())
      throw fields.error("there are more fields than the header has columns", wanted);
    point.push_back(settingOf(columns[point.size()], fields));
  }
  if (point.size() < columns.size())
    throw fields.error(fmt::format("the line ends after {} fields", point.size()), wanted);
  return point;
}

PointList readTable(std::string_view text) {
  TableLines lines(text);
  if (!lines.next())
    throw ioError("the table is empty", "a line of names of parameters, then one line a point");
  const std::vector<std::string> columns = columnsOf(lines);
  PointList points;
  while (lines.next()) points.push_back(pointOf(lines, columns));
  if (points.empty()) throw ioError("there are no points behind the header", "one line or more");
  return points;
}

void checkNames(const std::vector<PointList>& lists) {
  std::set<std::string> names;
  for (const PointList& list : lists)
    for (const Setting& setting : list.front())
      if (!names.insert(setting.name).second)
        throw usageError(inQuotes(setting.name) + " is set by two options", "one option for each parameter");
}

void checkNumber(const std::vector<PointList>& lists) {
  std::size_t number = 1;
  for (const PointList& list : lists) {
    if (list.size() > kMaxPoints / number)
      throw usageError("the sweep has too many points", fmt::format("{} at most", kMaxPoints));
    number *= list.size();
  }
}

void checkDifferent(const PointList& points) {
  std::map<std::string, std::size_t> numbers;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const auto [first, isNew] = numbers.emplace(folderNameOf(points[i]), i + 1); !isNew)
      throw usageError(
          fmt::format("points {} and {} are the same: {}", first->second, i + 1, describe(points[i])),
          "points that differ");
}

PointList product(const PointList& slow, const PointList& fast) {
  PointList all;
  for (const Point& outer : slow)
    for (const Point& inner : fast) {
      all.push_back(outer);
      all.back().insert(all.back().end(), inner.begin(), inner.end());
    }
  return all;
}

bool mayStandInName(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view(".,=_+-").find(c) != std::string_view::npos;
}

std::string joined(const Point& point, std::string_view is, std::string_view then) {
  std::string text;
  for (const Setting& setting : point)
    text.append(text.empty() ? "" : then).append(setting.name).append(is).append(setting.value);
  return text;
}

}  // namespace

PointList listedPoints(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos)
    throw usageError("--set " + printable(text, 200) + " has no '='", kForm);
  PointList points;
  for (const std::string& value : partsOf(text.substr(equals + 1)))
    points.push_back({settingOf(std::string(text.substr(0, equals)), value)});
  return points;
}

PointList tablePoints(const std::filesystem::path& file) {
  const std::string text = readTextFile(file, kLargestTable);
  try {
    return readTable(text);
  } catch (Error& e) {
    throw e.at({.file = file.string()});
  }
}

PointList productOf(const std::vector<PointList>& lists) {
  checkNames(lists);
  checkNumber(lists);
  PointList points(1);
  for (const PointList& list : lists) points = product(points, list);
  checkDifferent(points);
  return points;
}

std::string folderNameOf(const Point& point) {
  constexpr std::size_t kLongest = 120;
  const std::string text = joined(point, "=", ",");
  std::string name = text.substr(0, kLongest);
  for (char& c : name)
    if (!mayStandInName(c)) c = '_';
  if (name == text && !name.empty()) return name;
  return fmt::format("{}-{:08x}", name, static_cast<std::uint32_t>(hashOf(text)));
}

std::string describe(const Point& point) {
  return printable(joined(point, " = ", ", "), 500);
}

}  // namespace weir::app
