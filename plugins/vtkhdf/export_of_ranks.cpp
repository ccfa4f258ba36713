#include "plugins/vtkhdf/export_of_ranks.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <system_error>

#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "plugins/vtkhdf/polydata_file.h"
#include "plugins/vtkhdf/rank_files.h"

namespace weir {

namespace fs = std::filesystem;

fs::path ExportOfRanks::real() const {
  std::error_code error;
  return fs::weakly_canonical(fs::absolute(file_, error), error);
}

fs::path ExportOfRanks::folder() const {
  return real().parent_path() / folderOfRanks(real());
}

fs::path ExportOfRanks::ownFile() const {
  return folder() / fileOfRank(rank());
}

void ExportOfRanks::begin() {
  if (rank() == 0) {
    checkWritable(file_);
    std::error_code error;
    fs::create_directory(folder(), error);
    if (error) throw ioError("cannot make the folder: " + error.message()).at({.file = folder().string()});
  }
  ranks_.sum(0);  // so that nobody is ahead of the folder
}

void ExportOfRanks::prepare(const VtkHdfLayout& layout, const ExportTexts& texts) {
  layout_ = layout;
  texts_ = texts;
  if (rank() == 0) {
    std::error_code ignored;
    complete_ = std::ssize(steps_);
    if (!steps_.empty())
      writeFile(complete_);
    else
      fs::remove(file_, ignored);
    removeOthersFiles();
  }
  ranks_.sum(0);
}

/// Of an earlier export of more ranks.
void ExportOfRanks::removeOthersFiles() const {
  std::error_code ignored;
  for (int other = ranks_.size(); fs::remove(folder() / fileOfRank(other), ignored); ++other) {
  }
}

FrameOfRanks ExportOfRanks::share(const std::vector<std::int64_t>& counts, std::int64_t written) {
  std::vector<std::int64_t> own = counts;
  own.push_back(written);
  const auto bytes = std::as_bytes(std::span(own));
  const std::vector<Message> all = ranks_.allGather(Message(bytes.begin(), bytes.end()));
  FrameOfRanks frame{.counts = std::vector<std::int64_t>(counts.size() * all.size()), .complete = written};
  for (std::size_t rank = 0; rank < all.size(); ++rank) {
    std::memcpy(own.data(), all[rank].data(), bytes.size());
    for (std::size_t i = 0; i < counts.size(); ++i) frame.counts[i * all.size() + rank] = own[i];
    frame.complete = std::min(frame.complete, own.back());
  }
  return frame;
}

void ExportOfRanks::add(const VtkHdfFrame& own, const FrameOfRanks& frame) {
  if (rank() > 0) return;
  std::vector<double> fields = own.fields;
  const std::int64_t all = std::accumulate(frame.counts.begin(), frame.counts.end(), std::int64_t{0});
  fields.front() = static_cast<double>(all);
  addStep(own.time, fields, frame.counts);
  complete_ = std::max(complete_, frame.complete);
  // Its time grows with the frames that it names, so it is given a twentieth of all.
  constexpr int kShare = 20;
  if (complete_ > inFile_ && Clock::now() - writtenAt_ >= kShare * cost_) writeFile(complete_);
}

void ExportOfRanks::addStep(double time, const std::vector<double>& fields,
                            const std::vector<std::int64_t>& counts) {
  const auto ranks = static_cast<std::size_t>(ranks_.size());
  rowsOfRanks_.resize(ranks);
  VirtualStep& step = steps_.emplace_back(VirtualStep{.time = time, .fields = fields, .rows = {}});
  for (std::size_t i = 0; i < counts.size(); ++i) {
    std::int64_t& next = rowsOfRanks_[i % ranks];
    step.rows.push_back({.file = static_cast<int>(i % ranks), .first = next, .count = counts[i]});
    next += counts[i];
  }
}

void ExportOfRanks::complete(const ExportTexts& more) {
  ranks_.sum(0);
  if (rank() > 0) return;
  texts_.insert(texts_.end(), more.begin(), more.end());
  complete_ = std::ssize(steps_);
  writeFile(complete_);
}

void ExportOfRanks::keepComplete() {
  if (rank() == 0 && complete_ > inFile_) writeFile(complete_);
}

void ExportOfRanks::removeEmptyFolder() const {
  std::error_code ignored;
  if (rank() == 0) fs::remove(folder(), ignored);  // which does not remove what is in it
}

void ExportOfRanks::writeFile(std::int64_t frames) {
  const Clock::time_point start = Clock::now();
  const hdf5::Session session;
  const std::string below = folderOfRanks(real()) + "/";
  VirtualSteps from{.files = {}, .counting = below + kCountingFile, .steps = {}};
  from.steps = std::span(steps_).first(static_cast<std::size_t>(frames));
  for (int rank = 0; rank < ranks_.size(); ++rank) from.files.push_back(below + fileOfRank(rank));
  std::int64_t most = 0;
  for (const VirtualStep& step : from.steps) most = std::max(most, step.points());
  writeCounting(most + 1);
  PolyDataFile::writeVirtual(file_, layout_, from, texts_);
  inFile_ = frames;
  writtenAt_ = Clock::now();
  cost_ = writtenAt_ - start;
}

void ExportOfRanks::writeCounting(std::int64_t numbers) {
  if (numbers <= counting_) return;
  // By half more, so that a growing fluid asks for it rarely.
  counting_ = std::max(numbers, counting_ + counting_ / 2);
  counting_ = (counting_ + kCountingChunk - 1) / kCountingChunk * kCountingChunk;
  PolyDataFile::writeCounting(folder() / kCountingFile, counting_);
}

void ExportOfRanks::save(const StateWriter& to) {
  complete();
  std::vector<double> times, fields;
  std::vector<std::int64_t> counts;
  for (const VirtualStep& step : steps_) {
    times.push_back(step.time);
    fields.insert(fields.end(), step.fields.begin(), step.fields.end());
    for (const VirtualStep::Rows& rows : step.rows) counts.push_back(rows.count);
  }
  to.put("ranks", ranks_.size());
  to.put("times", std::span<const double>(times));
  to.put("fields", std::span<const double>(fields));
  to.put("counts", std::span<const std::int64_t>(counts));
}

int ExportOfRanks::savedRanks(const StateReader& from) {
  int ranks = 1;
  if (from.has("ranks")) from.get("ranks", ranks);
  return ranks;
}

void ExportOfRanks::resume(const StateReader& from) {
  if (rank() > 0) return;
  const auto times = from.getAll<double>("times"), fields = from.getAll<double>("fields");
  const auto counts = from.getAll<std::int64_t>("counts");
  if (times.empty()) return;
  const auto of = [&](const auto& values, std::size_t step) {
    const auto each = static_cast<std::ptrdiff_t>(values.size() / times.size());
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(step) * each;
    return std::decay_t<decltype(values)>(first, first + each);
  };
  for (std::size_t step = 0; step < times.size(); ++step)
    addStep(times[step], of(fields, step), of(counts, step));
}

}  // namespace weir
