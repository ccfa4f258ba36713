#include "framework/base/digest.h"

#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>
#include <vector>

#include "framework/base/error.h"

namespace weir {

Digest& Digest::add(std::span<const std::byte> bytes) {
  const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
  if (!bytes.empty()) value_ = static_cast<std::uint32_t>(::crc32_z(value_, data, bytes.size()));
  return *this;
}

Digest& Digest::addText(std::string_view text) {
  return addNumber(static_cast<std::int64_t>(text.size())).add(std::as_bytes(std::span(text)));
}

Digest& Digest::addNumber(std::int64_t number) {
  return add(std::as_bytes(std::span(&number, 1)));
}

FileDigest digestOfFile(const std::filesystem::path& file) {
  const auto cannotRead = [&](int error) {
    return ioError("the file cannot be read: " + std::generic_category().message(error))
        .at({.file = file.string()});
  };
  const auto close = [](std::FILE* f) { std::fclose(f); };
  const std::unique_ptr<std::FILE, decltype(close)> opened(std::fopen(file.c_str(), "rbe"), close);
  if (opened == nullptr) throw cannotRead(errno);
  FileDigest result;
  Digest digest;
  std::vector<std::byte> block(std::size_t{1} << 20);
  while (const std::size_t got = std::fread(block.data(), 1, block.size(), opened.get())) {
    digest.add(std::span(block).first(got));
    result.bytes += got;
  }
  if (std::ferror(opened.get()) != 0) throw cannotRead(errno);
  result.digest = digest.value();
  return result;
}

}  // namespace weir
