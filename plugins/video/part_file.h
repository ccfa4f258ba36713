// What may fail while it is written: a file under a name of its own beside its place, until it is complete
// ("run.part.mp4" for "run.mp4"), or what is appended to a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "framework/base/error.h"

namespace weir::rendering {

/// "the file cannot be written: <reason>", at this file.
Error cannotWrite(const std::filesystem::path& file, const std::string& reason, const std::string& hint = {});

enum class PartPlace { kBeside, kAppended };

/// Beside its place, the name keeps the extension, so that other programs know what is in it, and is one that
/// no file has: what a killed run left behind, or another run is writing, is not touched ("run.part2.mp4").
class PartFile {
 public:
  /// Makes an empty file beside `target`. Throws an io Error, which names the target, if the target is a
  /// folder or no regular file, if the folder above is missing, or if no file can be made in it.
  /// kAppended: throws if there is no such file.
  explicit PartFile(std::filesystem::path target, PartPlace place = PartPlace::kBeside);
  /// Removes the file, or what was appended, unless keep() has been called.
  ~PartFile();
  /// Removes what a killed run left beside the target: for its own successor, which makes it again.
  static void removeLeft(const std::filesystem::path& target);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& target() const { return target_; }
  /// How large the file was to begin with.
  std::uintmax_t begin() const { return begin_; }

  /// Replaces the content. Throws an io Error that names the target.
  void write(std::span<const std::uint8_t> bytes);
  /// Beside its place: renames to the target; a file there is replaced. Throws an io Error.
  void keep();

 private:
  std::filesystem::path target_, path_;
  std::uintmax_t begin_ = 0;
  bool kept_ = false;
};

}  // namespace weir::rendering
