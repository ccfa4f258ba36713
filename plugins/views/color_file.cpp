#include "plugins/views/color_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLargestFile = 4 << 20;  // bytes
constexpr std::size_t kResampled = 256;

struct Stop {
  double value = 0;
  Vec3d color;
};

struct Table {
  std::vector<Stop> stops;
  std::vector<int> lines;  ///< of each
  bool hasValues = false;
};

Error wrongLine(const fs::path& file, int line, const std::string& what, const std::string& allowed) {
  return ioError(what, allowed).at({.file = file.string(), .line = line});
}

/// The numbers of a line; none if one of its cells is not a number.
std::vector<double> numbersOf(std::string_view line) {
  std::vector<double> numbers;
  const auto isGap = [](char c) { return c == ',' || c == ';' || c == ' ' || c == '\t' || c == '\r'; };
  while (!line.empty()) {
    if (isGap(line.front())) {
      line.remove_prefix(1);
      continue;
    }
    double number = 0;
    const auto end = std::from_chars(line.data(), line.data() + line.size(), number);
    const auto length = static_cast<std::size_t>(end.ptr - line.data());
    if (end.ec != std::errc() || (length < line.size() && !isGap(line[length]))) return {};
    numbers.push_back(number);
    line.remove_prefix(length);
  }
  return numbers;
}

Table readCsv(const fs::path& file, const std::string& text) {
  Table table;
  std::istringstream lines(text);
  int number = 0;
  std::size_t columns = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    const std::vector<double> cells = numbersOf(line);
    if (cells.empty() && table.stops.empty() && number == 1) continue;  // the names of the columns
    const bool fits = columns == 0 ? cells.size() == 3 || cells.size() == 4 : cells.size() == columns;
    if (!fits)
      throw wrongLine(file, number, "a colour map has the line " + inQuotes(line),
                      columns == 4   ? "a value, red, green and blue, as in the lines before"
                      : columns == 3 ? "red, green and blue, as in the lines before"
                                     : "red, green and blue, or a value, red, green and blue");
    columns = cells.size();
    const std::size_t first = columns - 3;
    table.stops.push_back({first == 1 ? cells[0] : 0, {cells[first], cells[first + 1], cells[first + 2]}});
    table.lines.push_back(number);
  }
  table.hasValues = columns == 4;
  return table;
}

Table readPreset(const fs::path& file, const std::string& text) {
  Value json = parseJson(text, file.string());
  const Value& preset = json.isArray() && !json.asArray().empty() ? json.asArray().front() : json;
  const Value* points = preset.find("RGBPoints");
  const std::string allowed = "a list of presets with \"RGBPoints\": [value, red, green, blue, …]";
  if (points == nullptr || !points->isArray() || points->asArray().size() % 4 != 0)
    throw ioError("this is not a ParaView colour map", allowed).at({.file = file.string()});
  Table table;
  table.hasValues = true;
  const Value::Array& numbers = points->asArray();
  for (const Value& number : numbers)
    if (!number.isNumber())
      throw wrongLine(file, number.line, "RGBPoints holds " + number.brief(), "numbers");
  for (std::size_t i = 0; i < numbers.size(); i += 4) {
    table.stops.push_back(
        {numbers[i].asDouble(),
         {numbers[i + 1].asDouble(), numbers[i + 2].asDouble(), numbers[i + 3].asDouble()}});
    table.lines.push_back(numbers[i].line);
  }
  return table;
}

/// Brings components to [0, 1].
void checkColors(const fs::path& file, Table& table) {
  double largest = 0;
  for (const Stop& stop : table.stops)
    for (int c = 0; c < 3; ++c) largest = std::max(largest, stop.color[c]);
  const double white = largest > 1 ? 255 : 1;
  for (std::size_t i = 0; i < table.stops.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      double& component = table.stops[i].color[c];
      if (!(component >= 0 && component <= white))
        throw wrongLine(file, table.lines[i], "a colour map has the component " + std::to_string(component),
                        white == 1 ? "0 to 1" : "0 to 255, or 0 to 1 in all lines");
      component /= white;
    }
}

void checkValues(const fs::path& file, const Table& table) {
  for (std::size_t i = 1; i < table.stops.size(); ++i)
    if (!(table.stops[i].value > table.stops[i - 1].value))
      throw wrongLine(file, table.lines[i],
                      "the value " + std::to_string(table.stops[i].value) + " is not above the one before",
                      "values that grow");
}

Vec3f toFloat(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

std::vector<Vec3f> evenlySpread(const std::vector<Stop>& stops) {
  std::vector<Vec3f> colors;
  const double low = stops.front().value, high = stops.back().value;
  std::size_t right = 1;
  for (std::size_t i = 0; i < kResampled; ++i) {
    const double value = low + (high - low) * static_cast<double>(i) / (kResampled - 1);
    while (right + 1 < stops.size() && stops[right].value < value) ++right;
    const Stop &a = stops[right - 1], &b = stops[right];
    const double part = std::clamp((value - a.value) / (b.value - a.value), 0.0, 1.0);
    colors.push_back(toFloat(a.color * (1 - part) + b.color * part));
  }
  return colors;
}

}  // namespace

std::vector<Vec3f> readColorFile(const fs::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  if (extension != ".csv" && extension != ".json")
    throw ioError("a colour map cannot be read from a file of this name", "names that end in .csv or .json")
        .at({.file = file.string()});
  const std::string text = readTextFile(file, kLargestFile);
  Table table = extension == ".csv" ? readCsv(file, text) : readPreset(file, text);
  if (table.stops.size() < 2)
    throw ioError("the colour map has " + std::to_string(table.stops.size()) + " colours", "two or more")
        .at({.file = file.string()});
  checkColors(file, table);
  if (table.hasValues) {
    checkValues(file, table);
    return evenlySpread(table.stops);
  }
  std::vector<Vec3f> colors;
  for (const Stop& stop : table.stops) colors.push_back(toFloat(stop.color));
  return colors;
}

}  // namespace weir::rendering
