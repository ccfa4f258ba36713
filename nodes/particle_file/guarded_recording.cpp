#include "nodes/particle_file/guarded_recording.h"

#include <string>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/text.h"
#include "framework/graph/guard.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

class GuardedRecording final : public Recording {
 public:
  GuardedRecording(std::unique_ptr<Recording> recording, GuardedPart part)
      : recording_(std::move(recording)), part_(std::move(part)) {
    part_.call("times", [&] { times_ = recording_->times(); });
    part_.call("fluids", [&] { fluids_ = recording_->fluids(); });
  }

  const std::vector<double>& times() const override { return times_; }
  const std::vector<std::string>& fluids() const override { return fluids_; }
  std::vector<RecordedFluid> read(std::size_t frame) const override {
    std::vector<RecordedFluid> fluids;
    part_.call("read", [&] { fluids = recording_->read(frame); });
    return fluids;
  }

 private:
  std::unique_ptr<Recording> recording_;
  GuardedPart part_;
  std::vector<double> times_;
  std::vector<std::string> fluids_;
};

class GuardedReader final : public RecordingReader {
 public:
  GuardedReader(std::unique_ptr<RecordingReader> reader, GuardedPart part)
      : reader_(std::move(reader)), part_(std::move(part)) {
    part_.call("extensions", [&] { extensions_ = reader_->extensions(); });
  }

  std::vector<std::string> extensions() const override { return extensions_; }
  std::unique_ptr<Recording> open(const fs::path& file) const override {
    std::unique_ptr<Recording> recording;
    part_.call("open", [&] {
      recording = reader_->open(file);
      WEIR_CHECK(recording != nullptr);
    });
    return std::make_unique<GuardedRecording>(std::move(recording), part_);
  }

 private:
  std::unique_ptr<RecordingReader> reader_;
  GuardedPart part_;
  std::vector<std::string> extensions_;
};

}  // namespace

std::vector<std::unique_ptr<RecordingReader>> guardedRecordingReaders(const Registry& registry) {
  std::vector<std::unique_ptr<RecordingReader>> readers;
  for (auto& [name, reader, source] : registry.createServices<RecordingReader>())
    readers.push_back(std::make_unique<GuardedReader>(
        std::move(reader), GuardedPart{"recording reader " + inQuotes(name), source}));
  return readers;
}

}  // namespace weir
