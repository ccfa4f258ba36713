#include "framework/run/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "framework/base/file_output.h"
#include "framework/run/statistics.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

/// Numbers of one frame, by column.
using Row = std::map<std::string, std::string>;

/// Columns in the order in which they were met first.
class Table {
 public:
  void put(Row& row, const std::string& column, std::string number) {
    if (known_.insert(column).second) columns_.push_back(column);
    row[column] = std::move(number);
  }

  /// Adds the numbers below a value.
  void addNumbers(Row& row, const std::string& path, const Value& value) {
    const auto below = [&](const std::string& name) { return path.empty() ? name : path + "." + name; };
    if (value.isObject()) {
      // The nodes' names are enough to tell their numbers apart.
      for (const auto& [name, member] : value.asObject())
        addNumbers(row, path.empty() && name == "nodes" ? "" : below(name), member);
    } else if (value.isInt()) {
      put(row, path, fmt::format("{}", value.asInt()));
    } else if (value.isNumber()) {
      put(row, path, fmt::format("{}", value.asDouble()));
    } else if (value.isArray() && value.asArray().size() == 3 && value.asArray()[0].isNumber()) {
      for (std::size_t i = 0; i < 3; ++i)
        addNumbers(row, below(std::string(1, "xyz"[i])), value.asArray()[i]);
    }
  }

  void add(Row row) { rows_.push_back(std::move(row)); }

  std::string text() const {
    std::string result = fmt::format("{}\n", fmt::join(columns_, ","));
    for (const Row& row : rows_) {
      std::string line;
      for (const std::string& column : columns_) {
        const auto found = row.find(column);
        line +=
            (&column == columns_.data() ? "" : ",") + (found != row.end() ? found->second : std::string());
      }
      result += line + "\n";
    }
    return result;
  }

 private:
  std::vector<std::string> columns_;
  std::set<std::string> known_;
  std::vector<Row> rows_;
};

}  // namespace

std::string tableOf(std::string_view jsonLines) {
  constexpr double kMsPerSecond = 1000;
  Table table;
  double steps = 0, seconds = 0;
  while (!jsonLines.empty()) {
    const std::size_t end = std::min(jsonLines.find('\n'), jsonLines.size());
    const Value frame = parseJson(std::string(jsonLines.substr(0, end)), "the series");
    jsonLines.remove_prefix(std::min(end + 1, jsonLines.size()));
    Row row;
    table.addNumbers(row, "", frame);
    const double stepsNow = frame.find("steps")->asDouble(),
                 secondsNow = frame.find("stepping_seconds")->asDouble();
    if (stepsNow > steps)
      table.put(row, "ms_per_step",
                fmt::format("{:.4g}", kMsPerSecond * (secondsNow - seconds) / (stepsNow - steps)));
    steps = stepsNow, seconds = secondsNow;
    table.add(std::move(row));
  }
  return table.text();
}

void SeriesOutput::begin(Simulation&) {
  checkWritable(file_);
  lines_.clear();
}

std::unique_ptr<Snapshot> SeriesOutput::capture(Simulation& simulation, std::unique_ptr<Snapshot>) {
  lines_ += writeJsonLine(frameStatistics(simulation));
  return nullptr;
}

void SeriesOutput::save(const StateWriter& to) {
  to.put("lines", std::span<const char>(lines_));
}

void SeriesOutput::resume(Simulation& simulation, const StateReader& from) {
  begin(simulation);
  const std::vector<char> lines = from.getAll<char>("lines");
  lines_.assign(lines.begin(), lines.end());
}

void SeriesOutput::end(Simulation&, RunEnd) {
  writeFileAtomically(file_, file_.extension() == ".csv" ? tableOf(lines_) : lines_);
}

}  // namespace weir
