#include "nodes/particle_file/guarded_recording.h"

#include <functional>
#include <string>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/text.h"
#include "framework/graph/guard.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

/// What is called, and of which library: "recording reader 'vtkhdf'".
struct Part {
  std::string what, source;

  void guarded(std::string_view hook, const std::function<void()>& f) const {
    constexpr bool kFilesSayEnough = true;
    callGuarded(
        source, [&] { return hookText(what, hook, source); }, f, kFilesSayEnough);
  }
};

class GuardedRecording final : public Recording {
 public:
  GuardedRecording(std::unique_ptr<Recording> recording, Part part)
      : recording_(std::move(recording)), part_(std::move(part)) {
    part_.guarded("times", [&] { times_ = recording_->times(); });
    part_.guarded("fluids", [&] { fluids_ = recording_->fluids(); });
  }

  const std::vector<double>& times() const override { return times_; }
  const std::vector<std::string>& fluids() const override { return fluids_; }
  std::vector<RecordedFluid> read(std::size_t frame) const override {
    std::vector<RecordedFluid> fluids;
    part_.guarded("read", [&] { fluids = recording_->read(frame); });
    return fluids;
  }

 private:
  std::unique_ptr<Recording> recording_;
  Part part_;
  std::vector<double> times_;
  std::vector<std::string> fluids_;
};

class GuardedReader final : public RecordingReader {
 public:
  GuardedReader(std::unique_ptr<RecordingReader> reader, Part part)
      : reader_(std::move(reader)), part_(std::move(part)) {
    part_.guarded("extensions", [&] { extensions_ = reader_->extensions(); });
  }

  std::vector<std::string> extensions() const override { return extensions_; }
  std::unique_ptr<Recording> open(const fs::path& file) const override {
    std::unique_ptr<Recording> recording;
    part_.guarded("open", [&] {
      recording = reader_->open(file);
      WEIR_CHECK(recording != nullptr);
    });
    return std::make_unique<GuardedRecording>(std::move(recording), part_);
  }

 private:
  std::unique_ptr<RecordingReader> reader_;
  Part part_;
  std::vector<std::string> extensions_;
};

}  // namespace

std::vector<std::unique_ptr<RecordingReader>> guardedRecordingReaders(const Registry& registry) {
  std::vector<std::unique_ptr<RecordingReader>> readers;
  for (auto& [name, reader, source] : registry.createServices<RecordingReader>())
    readers.push_back(std::make_unique<GuardedReader>(std::move(reader),
                                                      Part{"recording reader " + inQuotes(name), source}));
  return readers;
}

}  // namespace weir
