// A text file that stands in its place from the start and grows piece by piece, so that nothing of it is kept
// in memory, and that a later run can go on with.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "framework/base/api.h"
#include "framework/base/digest.h"

namespace WEIR_API weir {

/// All throw io Errors that name the file.
class GrowingFile {
 public:
  /// How far a file has got, and what stands in it up to there.
  struct Mark {
    std::int64_t bytes = 0;
    std::int64_t digest = 0;  ///< CRC-32 of these bytes
  };

  static Mark markOf(std::string_view text);

  /// An empty file in place of what stood there.
  explicit GrowingFile(std::filesystem::path path);
  /// Goes on behind the mark; what follows it is cut. Throws, and changes nothing, if what is before the mark
  /// is not as it was, or is gone.
  GrowingFile(std::filesystem::path path, const Mark& mark);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// Hands the text to the operating system. After an error the file ends where it ended before.
  void append(std::string_view text);
  /// Waits until all is on the disk.
  Mark sync();
  /// After sync().
  void close();

 private:
  void open();
  void digestUpTo(std::int64_t bytes);

  std::filesystem::path path_;
  int file_ = -1;
  std::int64_t bytes_ = 0;
  Digest digest_;
};

}  // namespace weir
