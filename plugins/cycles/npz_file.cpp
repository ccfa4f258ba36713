#include "plugins/cycles/npz_file.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <limits>

#include "framework/base/error.h"

namespace weir::rendering {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<std::uint32_t, 256> makeTable() {
  constexpr std::uint32_t kPolynomial = 0xedb88320;
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t rest = i;
    for (int bit = 0; bit < 8; ++bit) rest = (rest & 1) != 0 ? kPolynomial ^ rest >> 1 : rest >> 1;
    table[i] = rest;
  }
  return table;
}

/// The checksum of zip archives (ISO 3309), of bytes that follow those whose checksum is `before`.
std::uint32_t checksum(std::span<const std::byte> bytes, std::uint32_t before = 0) {
  static constexpr std::array<std::uint32_t, 256> kTable = makeTable();
  std::uint32_t rest = ~before;
  for (const std::byte byte : bytes)
    rest = kTable[(rest ^ std::to_integer<std::uint32_t>(byte)) & 0xff] ^ rest >> 8;
  return ~rest;
}

template <class... Numbers>
void put(std::string& to, Numbers... numbers) {
  const auto one = [&](auto number) { to.append(reinterpret_cast<const char*>(&number), sizeof number); };
  (one(numbers), ...);
}

std::string_view textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What stands before the numbers of an array.
std::string arrayHeader(std::string_view type, const std::string& shape) {
  constexpr std::size_t kStart = 10, kUnit = 64;  // bytes before the text; the numbers begin at a multiple
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  const std::size_t length = kStart + text.size() + 1;
  text.append((kUnit - length % kUnit) % kUnit, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  put(header, static_cast<std::uint16_t>(text.size()));
  return header + text;
}

/// What the entries of an archive say of a file, twice: before it and in the directory at the end.
std::string fileHeader(std::uint32_t sum, std::uint32_t size, std::string_view name) {
  constexpr std::uint16_t kVersion = 20, kFlags = 0, kStored = 0, kTime = 0, kDate = 0x21;  // of 1980
  std::string header;
  put(header, kVersion, kFlags, kStored, kTime, kDate, sum, size, size,
      static_cast<std::uint16_t>(name.size()), std::uint16_t{0});
  return header;
}

}  // namespace

void NpzFile::add(std::string_view name, std::span<const float> values) {
  add(name, "<f4", fmt::format("({},)", values.size()), std::as_bytes(values));
}

void NpzFile::add(std::string_view name, std::span<const Vec3f> values) {
  add(name, "<f4", fmt::format("({}, 3)", values.size()), std::as_bytes(values));
}

void NpzFile::add(std::string_view name, std::span<const Vec3i> values) {
  add(name, "<i4", fmt::format("({}, 3)", values.size()), std::as_bytes(values));
}

void NpzFile::add(std::string_view name, std::string_view bytes) {
  add(name, "|u1", fmt::format("({},)", bytes.size()), std::as_bytes(std::span(bytes)));
}

void NpzFile::add(std::string_view name, std::span<const Vec3f> values, int height, int width) {
  add(name, "<f4", fmt::format("({}, {}, 3)", height, width), std::as_bytes(values));
}

void NpzFile::add(std::string_view name, std::string_view type, const std::string& shape,
                  std::span<const std::byte> bytes) {
  const std::string file = std::string(name) + ".npy", header = arrayHeader(type, shape);
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max(),
                        kRoom = 1 << 20;  // for the directory
  if (content_.size() + header.size() + bytes.size() + kRoom > kMost)
    throw ioError("a frame for Blender would be larger than 4 GB", "fewer particles, or a coarser surface");
  const auto size = static_cast<std::uint32_t>(header.size() + bytes.size());
  const std::uint32_t sum = checksum(bytes, checksum(std::as_bytes(std::span(header))));
  const std::string about = fileHeader(sum, size, file);
  const auto place = static_cast<std::uint32_t>(content_.size());
  content_ += "PK\x03\x04" + about + file + header;
  content_ += textOf(bytes);
  directory_ += std::string("PK\x01\x02\x14\x00", 6) + about;
  put(directory_, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0}, std::uint32_t{0}, place);
  directory_ += file;
  ++entries_;
}

std::string NpzFile::finish() && {
  const auto begin = static_cast<std::uint32_t>(content_.size());
  const auto entries = static_cast<std::uint16_t>(entries_);
  content_ += directory_;
  content_ += "PK\x05\x06";
  put(content_, std::uint16_t{0}, std::uint16_t{0}, entries, entries,
      static_cast<std::uint32_t>(directory_.size()), begin, std::uint16_t{0});
  return std::move(content_);
}

}  // namespace weir::rendering
