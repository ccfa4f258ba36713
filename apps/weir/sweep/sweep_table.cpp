#include "apps/weir/sweep/sweep_table.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "apps/weir/sweep/point_folder.h"
#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "framework/base/output_lock.h"
#include "framework/base/table_text.h"
#include "framework/run/numbers_of.h"

namespace weir::app {

namespace {

/// Lines of named fields; columns stand in the order in which they came.
class Table {
 public:
  void addLine() { lines_.emplace_back(); }
  /// Into the last line.
  void put(const std::string& column, std::string field) {
    const auto [found, isNew] = places_.emplace(column, columns_.size());
    if (isNew) columns_.push_back(column);
    std::vector<std::string>& line = lines_.back();
    if (line.size() < columns_.size()) line.resize(columns_.size());
    line[found->second] = std::move(field);
  }
  std::string text() const {
    std::string text = tableLine(columns_);
    for (std::vector<std::string> line : lines_) {
      line.resize(columns_.size());
      text += tableLine(line);
    }
    return text;
  }

 private:
  std::map<std::string, std::size_t> places_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> lines_;
};

void putPoint(Table& table, std::size_t number, const Point& point) {
  table.addLine();
  table.put("point", std::to_string(number));
  table.put("folder", folderNameOf(point));
  for (const Setting& setting : point) table.put(setting.name, setting.value);
}

/// Whether a member of the statistics tells of the machine and of how the run came about.
bool isOfMachine(const std::string& member) {
  for (const char* name : {"wall_seconds", "setup_seconds", "stepping_seconds", "step_ms", "outputs",
                           "modules_ms", "memory", "blocking_readbacks"})
    if (member == name) return true;
  return false;
}

std::int64_t eventCount(const Value& events) {
  std::int64_t count = 0;
  if (events.isArray())
    for (const Value& event : events.asArray())
      if (const Value* number = event.find("count"); number != nullptr && number->isInt())
        count += number->asInt();
  return count;
}

/// A parameter keeps its column where a number has its name, too.
void putNumbers(Table& table, const Value& statistics, const Point& point) {
  for (auto& [column, number] : numbersOf(statistics)) {
    bool isTaken = false;
    for (const Setting& setting : point) isTaken = isTaken || setting.name == column;
    table.put(isTaken ? column + " (measured)" : column, std::move(number));
  }
}

struct Tables {
  Table results, times;
};

void addPoint(Tables& tables, std::size_t number, const Point& point, const PointFolder& folder) {
  const PointState state = folder.state();
  for (Table* table : {&tables.results, &tables.times}) {
    putPoint(*table, number, point);
    table->put("state", std::string(nameOf(state)));
  }
  const std::optional<PointError> error = folder.error();
  tables.results.put("error", error ? error->text : "");
  const std::optional<Value> statistics =
      state == PointState::kDone ? folder.statistics() : std::optional<Value>();
  if (!statistics) return;
  Value results = Value::object(), times = Value::object();
  for (const auto& [name, member] : statistics->asObject())
    (isOfMachine(name) ? times : results)[name] = member;
  if (const Value* events = std::as_const(results).find("rare_events"))
    results["rare_events"] = eventCount(*events);
  putNumbers(tables.results, results, point);
  putNumbers(tables.times, times, point);
}

/// Waits for others, who need but a moment.
OutputLock lockSoon(const std::filesystem::path& file) {
  constexpr std::chrono::milliseconds kPause(20);
  constexpr int kTrials = 3000;
  for (int i = 0; i < kTrials; ++i) {
    try {
      return OutputLock(file);
    } catch (const Error&) {
      std::this_thread::sleep_for(kPause);
    }
  }
  return OutputLock(file);
}

}  // namespace

void writeTables(const std::filesystem::path& folder, const PointList& points) {
  const OutputLock lock = lockSoon(folder / "table.csv");
  Tables tables;
  for (std::size_t i = 0; i < points.size(); ++i)
    addPoint(tables, i + 1, points[i], PointFolder(folder / folderNameOf(points[i])));
  writeFileAtomically(folder / "times.csv", tables.times.text());
  writeFileAtomically(folder / "table.csv", tables.results.text());
}

std::string pointTable(const PointList& points) {
  Table table;
  for (std::size_t i = 0; i < points.size(); ++i) putPoint(table, i + 1, points[i]);
  return table.text();
}

}  // namespace weir::app
