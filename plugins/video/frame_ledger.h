// Tells which pictures of a folder show what they would show if they were drawn again: a file frames.txt
// there holds, for each picture, a digest of all that it was made of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "framework/base/vec.h"

namespace weir::rendering {

/// Of bytes, 64 bits (FNV-1a's way of mixing, eight bytes at a time). Different bytes have different digests
/// but for chance; nothing here is secret.
class Digest {
 public:
  void add(std::span<const std::byte> bytes);
  void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
  template <class T>
  void addAll(std::span<const T> values) {
    add(std::as_bytes(values));
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037u;
};

class FrameLedger {
 public:
  /// Reads what the folder's file says; it may be missing, and lines that make no sense are passed over.
  explicit FrameLedger(std::filesystem::path folder);

  /// Removes the file, if there is one: pictures will be written that are not noted.
  static void remove(const std::filesystem::path& folder);

  /// Whether the picture of the frame is there and was made of this.
  bool has(std::int64_t frame, std::uint64_t digest) const;
  /// The picture of the frame will be made of this. Removes the one that is there, which may be another's:
  /// from now on a picture there is the right one. Throws an io Error if it cannot be noted.
  void note(std::int64_t frame, std::uint64_t digest);

 private:
  std::filesystem::path folder_;
  std::map<std::int64_t, std::uint64_t> digests_;
};

}  // namespace weir::rendering
