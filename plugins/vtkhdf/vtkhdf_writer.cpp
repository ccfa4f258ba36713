#include "plugins/vtkhdf/vtkhdf_writer.h"

#include <atomic>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "framework/base/check.h"
#include "plugins/vtkhdf/polydata_file.h"

namespace weir {

namespace {

/// The writer's own copy of a frame; its memory is used again for later frames.
class StoredFrame {
 public:
  void assign(const VtkHdfFrame& frame) {
    time_ = frame.time;
    fields_ = frame.fields;
    positions_.assign(frame.positions.begin(), frame.positions.end());
    attributes_.resize(frame.attributes.size());
    for (std::size_t i = 0; i < attributes_.size(); ++i)
      std::visit([&](const auto& values) { copy(values, attributes_[i]); }, frame.attributes[i]);
  }

  VtkHdfFrame view() const {
    VtkHdfFrame frame{.time = time_, .positions = positions_, .fields = fields_};
    for (const Storage& storage : attributes_)
      frame.attributes.push_back(
          std::visit([](const auto& values) { return VtkHdfValues(std::span(values)); }, storage));
    return frame;
  }

 private:
  using Storage = std::variant<std::vector<float>, std::vector<std::int32_t>, std::vector<std::int64_t>,
                               std::vector<std::uint32_t>>;

  template <class T>
  static void copy(std::span<const T> values, Storage& to) {
    if (!std::holds_alternative<std::vector<T>>(to)) to = std::vector<T>();
    std::get<std::vector<T>>(to).assign(values.begin(), values.end());
  }

  double time_ = 0;
  std::vector<Vec3f> positions_;
  std::vector<Storage> attributes_;
  std::vector<double> fields_;
};

/// A new one, or that of a run that is resumed, with its first frames.
std::unique_ptr<PolyDataFile> makeFile(const std::filesystem::path& file, const VtkHdfLayout& layout,
                                       std::optional<std::int64_t> frames) {
  const hdf5::Session session;
  if (frames) return std::make_unique<PolyDataFile>(file, layout, *frames);
  return std::make_unique<PolyDataFile>(file, layout);
}

}  // namespace

class VtkHdfWriter::Worker {
 public:
  Worker(const std::filesystem::path& file, VtkHdfLayout layout, std::optional<std::int64_t> frames)
      : layout_(std::move(layout)),
        framesWritten_(frames.value_or(0)),
        file_(makeFile(file, layout_, frames)),
        thread_([this] { run(); }) {}

  ~Worker() { finish(); }

  void append(const VtkHdfFrame& frame) {
    check(frame);
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !full_; });
    rethrow();
    lastTime_ = frame.time;
    // Only this thread touches the waiting frame while it is not full.
    lock.unlock();
    waiting_.assign(frame);
    lock.lock();
    full_ = true;
    changed_.notify_all();
  }

  void setText(const std::string& name, std::string_view text) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !full_ && !writing_; });
    rethrow();
    attempt([&] { file_->setText(name, text); });
    rethrow();
  }

  void sync() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !full_ && !writing_; });
    rethrow();
    attempt([&] { file_->sync(); });
    rethrow();
  }

  std::int64_t framesWritten() const { return framesWritten_; }

  void close() {
    finish();
    if (!reported_) rethrow();
  }

 private:
  void check(const VtkHdfFrame& frame) const {
    WEIR_CHECK(!stop_);
    WEIR_CHECK(std::isfinite(frame.time));
    WEIR_CHECK(frame.time > lastTime_);
    WEIR_CHECK(frame.fields.size() == layout_.fields.size());
    WEIR_CHECK(frame.attributes.size() == layout_.attributes.size());
    for (std::size_t i = 0; i < frame.attributes.size(); ++i) {
      const VtkHdfAttribute& attribute = layout_.attributes[i];
      // The alternatives of VtkHdfValues stand in the order of VtkHdfType.
      WEIR_CHECK(frame.attributes[i].index() == static_cast<std::size_t>(attribute.type));
      const std::size_t numbers =
          std::visit([](const auto& values) { return values.size(); }, frame.attributes[i]);
      WEIR_CHECK(numbers == frame.positions.size() * static_cast<std::size_t>(attribute.components));
    }
  }

  void run() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return full_ || stop_; });
      if (!full_) return;
      std::swap(waiting_, current_);
      full_ = false;
      writing_ = true;
      changed_.notify_all();
      lock.unlock();
      const std::exception_ptr error = file_ ? tryWrite() : nullptr;
      lock.lock();
      if (error) error_ = error;
      writing_ = false;
      changed_.notify_all();
    }
  }

  std::exception_ptr tryWrite() {
    return attemptUnlocked([&] {
      file_->write(current_.view());
      ++framesWritten_;
    });
  }

  /// Runs something that writes; if it fails, the file is given up as it is.
  template <class F>
  std::exception_ptr attemptUnlocked(const F& write) {
    const hdf5::Session session;
    try {
      write();
    } catch (...) {
      file_->abandon();
      file_.reset();
      return std::current_exception();
    }
    return nullptr;
  }

  template <class F>
  void attempt(const F& write) {
    if (const std::exception_ptr error = attemptUnlocked(write)) error_ = error;
  }

  void rethrow() {
    if (!error_) return;
    reported_ = true;
    std::rethrow_exception(error_);
  }

  /// Lets the thread write what it still has, then completes the file.
  void finish() {
    {
      const std::scoped_lock lock(mutex_);
      stop_ = true;
      changed_.notify_all();
    }
    if (thread_.joinable()) thread_.join();
    if (!file_) return;
    attempt([&] { file_->close(); });
    const hdf5::Session session;
    file_.reset();
  }

  const VtkHdfLayout layout_;
  double lastTime_ = -std::numeric_limits<double>::infinity();
  std::atomic<std::int64_t> framesWritten_ = 0;

  std::mutex mutex_;  // of all that follows, except that current_ and file_ are the thread's while writing_
  std::condition_variable changed_;
  StoredFrame waiting_, current_;
  bool full_ = false, writing_ = false, stop_ = false, reported_ = false;
  std::exception_ptr error_;
  std::unique_ptr<PolyDataFile> file_;
  std::thread thread_;
};

VtkHdfWriter::VtkHdfWriter(const std::filesystem::path& file, VtkHdfLayout layout)
    : worker_(std::make_unique<Worker>(file, std::move(layout), std::nullopt)) {}

VtkHdfWriter::VtkHdfWriter(const std::filesystem::path& file, VtkHdfLayout layout, std::int64_t frames)
    : worker_(std::make_unique<Worker>(file, std::move(layout), frames)) {}

VtkHdfWriter::~VtkHdfWriter() = default;

void VtkHdfWriter::append(const VtkHdfFrame& frame) {
  worker_->append(frame);
}

void VtkHdfWriter::setText(const std::string& name, std::string_view text) {
  worker_->setText(name, text);
}

void VtkHdfWriter::sync() {
  worker_->sync();
}

std::int64_t VtkHdfWriter::framesWritten() const {
  return worker_->framesWritten();
}

void VtkHdfWriter::close() {
  worker_->close();
}

}  // namespace weir
