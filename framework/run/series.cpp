#include "framework/run/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "framework/run/numbers_of.h"
#include "framework/run/statistics.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

/// Numbers of one frame, by column.
using Row = std::map<std::string, std::string>;

std::string contentsOf(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  if (!text) throw ioError("the file cannot be read").at({.file = path.string()});
  return std::move(text).str();
}

}  // namespace

/// Columns in the order in which they were met first, and lines of them.
class SeriesOutput::Table {
 public:
  explicit Table(std::vector<std::string> columns = {})
      : columns_(std::move(columns)), known_(columns_.begin(), columns_.end()) {}

  const std::vector<std::string>& columns() const { return columns_; }
  std::string header() const { return fmt::format("{}\n", fmt::join(columns_, ",")); }

  Row rowOf(const Value& frame) {
    constexpr double kMsPerSecond = 1000;
    Row row;
    for (auto& [column, number] : numbersOf(frame)) put(row, column, std::move(number));
    const double steps = frame.find("steps")->asDouble(),
                 seconds = frame.find("stepping_seconds")->asDouble();
    if (steps > steps_)
      put(row, "ms_per_step", fmt::format("{:.4g}", kMsPerSecond * (seconds - seconds_) / (steps - steps_)));
    steps_ = steps, seconds_ = seconds;
    return row;
  }

  std::string line(const Row& row) const {
    std::string text;
    for (const std::string& column : columns_) {
      const auto found = row.find(column);
      text += (&column == columns_.data() ? "" : ",") + (found != row.end() ? found->second : std::string());
    }
    return text + "\n";
  }

  /// The text of a table that had fewer columns, with empty fields in those that came to it.
  std::string widened(std::string_view table, std::size_t columnsBefore) const {
    const std::string more(columns_.size() - columnsBefore, ',');
    std::string text = header();
    table.remove_prefix(std::min(table.find('\n'), table.size() - 1) + 1);
    for (std::size_t end = 0; !table.empty(); table.remove_prefix(end + 1)) {
      end = std::min(table.find('\n'), table.size() - 1);
      text += std::string(table.substr(0, end)) + more + "\n";
    }
    return text;
  }

  void save(const StateWriter& to) const {
    to.put("steps", steps_);
    to.put("seconds", seconds_);
    to.put("columns", std::span<const char>(header()));
  }

  void restore(const StateReader& from) {
    from.get("steps", steps_);
    from.get("seconds", seconds_);
    const std::vector<char> names = from.getAll<char>("columns");
    std::istringstream header(std::string(names.begin(), names.empty() ? names.end() : names.end() - 1));
    for (std::string name; std::getline(header, name, ',');) add(name);
  }

 private:
  void add(const std::string& column) {
    if (known_.insert(column).second) columns_.push_back(column);
  }

  void put(Row& row, const std::string& column, std::string number) {
    add(column);
    row[column] = std::move(number);
  }

  std::vector<std::string> columns_;
  std::set<std::string> known_;
  double steps_ = 0, seconds_ = 0;  // of the frame before
};

SeriesOutput::SeriesOutput(std::filesystem::path file) : file_(std::move(file)) {}

SeriesOutput::~SeriesOutput() = default;

void SeriesOutput::begin(Simulation&) {
  checkWritable(file_);
  lines_.reset();
  table_ = file_.extension() == ".csv" ? std::make_unique<Table>() : nullptr;
}

std::unique_ptr<Snapshot> SeriesOutput::capture(Simulation& simulation, std::unique_ptr<Snapshot>) {
  if (!lines_) lines_.emplace(file_);
  const Value frame = frameStatistics(simulation);
  if (table_)
    addRow(frame);
  else
    lines_->append(writeJsonLine(frame));
  return nullptr;
}

void SeriesOutput::addRow(const Value& frame) {
  const std::size_t before = table_->columns().size();
  const Row row = table_->rowOf(frame);
  if (before == 0) lines_->append(table_->header());
  if (before > 0 && table_->columns().size() > before) {  // as a rule at frame 1
    const std::string text = table_->widened(contentsOf(file_), before);
    lines_.reset();
    writeFileAtomically(file_, text);
    lines_.emplace(file_, GrowingFile::markOf(text));
  }
  lines_->append(table_->line(row));
}

void SeriesOutput::save(const StateWriter& to) {
  if (!lines_) lines_.emplace(file_);
  const GrowingFile::Mark mark = lines_->sync();
  to.put("bytes", mark.bytes);
  to.put("digest", mark.digest);
  if (table_) table_->save(to);
}

void SeriesOutput::resume(Simulation& simulation, const StateReader& from) {
  begin(simulation);
  GrowingFile::Mark mark;
  from.get("bytes", mark.bytes);
  from.get("digest", mark.digest);
  if (table_) table_->restore(from);
  lines_.emplace(file_, mark);
}

void SeriesOutput::end(Simulation&, RunEnd) {
  if (!lines_) lines_.emplace(file_);
  lines_->sync();
  lines_->close();
  lines_.reset();
}

}  // namespace weir
