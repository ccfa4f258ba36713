// Digests by which damage and changes are seen: CRC-32, as zlib makes it. It sees every damage of up to 32
// bits in a row and misses one in four billion others. Who wants to deceive can: it is not a signature.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include "framework/base/api.h"

namespace WEIR_API weir {

class Digest {
 public:
  Digest& add(std::span<const std::byte> bytes);
  /// With its length, so that texts which follow each other cannot be taken for others.
  Digest& addText(std::string_view text);
  Digest& addNumber(std::int64_t number);
  std::uint32_t value() const { return value_; }

 private:
  std::uint32_t value_ = 0;
};

struct FileDigest {
  std::uint64_t bytes = 0;
  std::uint32_t digest = 0;
  friend bool operator==(const FileDigest&, const FileDigest&) = default;
};

/// Throws an io Error that names the file if it cannot be read.
FileDigest digestOfFile(const std::filesystem::path& file);

}  // namespace weir
