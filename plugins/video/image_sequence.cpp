#include "plugins/video/image_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/base/text.h"
#include "plugins/video/image_file.h"
#include "plugins/video/part_file.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

/// A picture takes longer to compress than to draw, so several are compressed at once.
int threadCount() {
  constexpr unsigned kMin = 2, kMax = 8, kShare = 3;
  return static_cast<int>(std::clamp(std::thread::hardware_concurrency() / kShare, kMin, kMax));
}
std::size_t longestQueue() {
  return static_cast<std::size_t>(2 * threadCount());
}

/// The number in the name of a frame; none if the name is not that of a frame.
std::optional<std::int64_t> frameOf(const std::string& name) {
  const std::string_view digits = std::string_view(name).substr(std::min<std::size_t>(name.size(), 6));
  std::int64_t frame = -1;
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), frame);
  if (end.ec != std::errc() || frame < 0 || ImageSequence::nameOf(frame) != name) return std::nullopt;
  return frame;
}

Error cannotUse(const fs::path& folder, const std::string& reason) {
  return ioError("the folder cannot be used for pictures: " + reason).at({.file = folder.string()});
}

void makeFolder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return;
  if (fs::exists(folder, error)) throw cannotUse(folder, "it is not a folder");
  fs::create_directory(folder, error);
  if (error) throw cannotUse(folder, error.message());
}

/// Fails here rather than after hours of simulation.
fs::path usable(fs::path folder) {
  makeFolder(folder);
  const PartFile probe(folder / ImageSequence::nameOf(0));
  return folder;
}

}  // namespace

std::string ImageSequence::nameOf(std::int64_t frame) {
  return fmt::format("frame_{:05}.png", frame);
}

ImageSequence::ImageSequence(fs::path folder, std::int64_t first)
    : folder_(usable(std::move(folder))),
      frameCount_(first),
      queue_(threadCount(), longestQueue(), [this, first](std::int64_t number, const Picture& picture) {
        writePng(folder_ / nameOf(first + number), picture);
      }) {}

void ImageSequence::write(Picture picture) {
  WEIR_CHECK(picture.isWhole());
  queue_.push(std::move(picture));
  ++frameCount_;
}

void ImageSequence::finish() {
  queue_.finish();
}

std::string ImageSequence::leftovers() const {
  std::vector<std::int64_t> frames;
  std::error_code error;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
    const std::optional<std::int64_t> frame = frameOf(entry->path().filename().string());
    if (frame && *frame >= frameCount_) frames.push_back(*frame);
  }
  if (frames.empty()) return {};
  const auto [first, last] = std::minmax_element(frames.begin(), frames.end());
  return fmt::format("{} holds {} more pictures of an earlier, longer run: {} to {}",
                     printable(folder_.string(), 1000), frames.size(), nameOf(*first), nameOf(*last));
}

}  // namespace weir::rendering
