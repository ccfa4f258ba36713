#include "plugins/video/frame_ledger.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "plugins/video/image_sequence.h"
#include "plugins/video/part_file.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

fs::path fileIn(const fs::path& folder) {
  return folder / "frames.txt";
}

}  // namespace

void Digest::add(std::span<const std::byte> bytes) {
  constexpr std::uint64_t kPrime = 1099511628211u;
  constexpr int kFold =
      32;  // so that the upper half of what was added reaches the lower half of what follows
  const auto mix = [&](std::uint64_t word) {
    value_ = (value_ ^ word) * kPrime;
    value_ ^= value_ >> kFold;
  };
  mix(bytes.size());
  while (!bytes.empty()) {
    std::uint64_t word = 0;
    const std::size_t size = std::min(bytes.size(), sizeof word);
    std::memcpy(&word, bytes.data(), size);
    mix(word);
    bytes = bytes.subspan(size);
  }
}

FrameLedger::FrameLedger(fs::path folder) : folder_(std::move(folder)) {
  std::ifstream file(fileIn(folder_));
  std::int64_t frame = 0;
  for (std::uint64_t digest = 0; file >> frame >> std::hex >> digest >> std::dec;) digests_[frame] = digest;
}

void FrameLedger::remove(const fs::path& folder) {
  std::error_code error;
  fs::remove(fileIn(folder), error);
  if (error) throw cannotWrite(fileIn(folder), error.message());
}

bool FrameLedger::has(std::int64_t frame, std::uint64_t digest) const {
  const auto found = digests_.find(frame);
  std::error_code error;
  return found != digests_.end() && found->second == digest &&
         fs::is_regular_file(folder_ / ImageSequence::nameOf(frame), error);
}

void FrameLedger::note(std::int64_t frame, std::uint64_t digest) {
  std::error_code error;
  fs::remove(folder_ / ImageSequence::nameOf(frame), error);
  if (error) throw cannotWrite(folder_ / ImageSequence::nameOf(frame), error.message());
  std::ofstream file(fileIn(folder_), std::ios::app);
  file << frame << ' ' << std::hex << digest << '\n';
  file.close();
  if (!file) throw cannotWrite(fileIn(folder_), "it cannot be added to");
  digests_[frame] = digest;
}

}  // namespace weir::rendering
