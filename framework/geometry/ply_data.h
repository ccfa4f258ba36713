// The data of a PLY file behind its header, number by number: for readers of particles and of meshes.
//
//   forEachPlyRow(content, header, [&](auto& numbers, const PlyElement& element) {
//     if (element.name == "vertex") x = numbers.next(element.properties[0].type); …
//     else skipPlyRow(numbers, element);
//   });
#pragma once

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/geometry/ply_header.h"

namespace weir {

/// The numbers of the data of an ASCII file, one after the other.
class PlyAsciiNumbers {
 public:
  PlyAsciiNumbers(std::string_view data, int line) : rest_(data), line_(line) {}

  void skip(PlyType) { nextWord(); }
  double next(PlyType) {
    std::string_view word = nextWord();
    double number = 0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (code == std::errc::invalid_argument || end != word.data() + word.size())
      throw ioError("found " + inQuotes(word), "a number").at(place());
    if (code != std::errc())
      throw ioError(inQuotes(word) + " is too large or too small", "a number").at(place());
    return number;
  }
  bool atEnd() {
    skipBlanks();
    return rest_.empty();
  }
  /// No file has more numbers left than this.
  std::uint64_t maxNumbersLeft(std::size_t) const { return rest_.size() / 2 + 1; }
  Location place() const { return {.line = line_, .column = 1}; }

 private:
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  void skipBlanks() {
    while (!rest_.empty() && isBlank(rest_.front())) {
      if (rest_.front() == '\n') ++line_;
      rest_.remove_prefix(1);
    }
  }
  std::string_view nextWord() {
    skipBlanks();
    std::size_t size = 0;
    while (size < rest_.size() && !isBlank(rest_[size])) ++size;
    if (size == 0) throw endOfFile();
    const std::string_view word = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return word;
  }
  Error endOfFile() const { return ioError("the file ends too early").at(place()); }

  std::string_view rest_;
  int line_;
};

/// The numbers of the data of a binary file.
class PlyBinaryNumbers {
 public:
  PlyBinaryNumbers(std::string_view data, bool littleEndian)
      : rest_(data), swap_(littleEndian != (std::endian::native == std::endian::little)) {}

  void skip(PlyType type) { take(sizeOf(type)); }
  double next(PlyType type) {
    switch (type) {
      case PlyType::kInt8:
        return as<std::int8_t>();
      case PlyType::kUint8:
        return as<std::uint8_t>();
      case PlyType::kInt16:
        return as<std::int16_t>();
      case PlyType::kUint16:
        return as<std::uint16_t>();
      case PlyType::kInt32:
        return as<std::int32_t>();
      case PlyType::kUint32:
        return as<std::uint32_t>();
      case PlyType::kFloat32:
        return as<float>();
      case PlyType::kFloat64:
        return as<double>();
    }
    return 0;
  }
  /// Some programs end a binary file with a line feed.
  bool atEnd() const { return rest_.find_first_not_of("\r\n") == std::string_view::npos; }
  std::uint64_t maxNumbersLeft(std::size_t bytesEach) const { return rest_.size() / bytesEach; }
  Location place() const { return {}; }

 private:
  std::string_view take(std::size_t size) {
    if (size > rest_.size()) throw ioError("the file ends too early");
    const std::string_view bytes = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return bytes;
  }
  template <class T>
  double as() {
    const std::string_view bytes = take(sizeof(T));
    char copy[sizeof(T)];
    std::memcpy(copy, bytes.data(), sizeof(T));
    if (swap_) std::reverse(copy, copy + sizeof(T));
    T value;
    std::memcpy(&value, copy, sizeof(T));
    return static_cast<double>(value);
  }

  std::string_view rest_;
  bool swap_;
};

/// Takes the length of a list, which is no longer than the rest of the file.
template <class Numbers>
std::uint64_t nextPlyLength(Numbers& numbers, const PlyProperty& list) {
  const double length = numbers.next(*list.lengthType);
  if (!(length >= 0) || length != std::floor(length))
    throw ioError("the list " + inQuotes(list.name) + " has no valid length", "an integer from 0 on")
        .at(numbers.place());
  if (length > static_cast<double>(numbers.maxNumbersLeft(sizeOf(list.type))))
    throw ioError("the file ends too early: the list " + inQuotes(list.name) + " is longer than the file")
        .at(numbers.place());
  return static_cast<std::uint64_t>(length);
}

template <class Numbers>
void skipPlyProperty(Numbers& numbers, const PlyProperty& property) {
  if (!property.lengthType) return numbers.skip(property.type);
  for (std::uint64_t left = nextPlyLength(numbers, property); left > 0; --left) numbers.skip(property.type);
}

template <class Numbers>
void skipPlyRow(Numbers& numbers, const PlyElement& element) {
  for (const PlyProperty& property : element.properties) skipPlyProperty(numbers, property);
}

namespace detail {

inline Error inPlyRow(const Error& error, const PlyElement& element, std::uint64_t row) {
  Error named = ioError(error.message() + ", in row " + std::to_string(row) + " of " +
                            std::to_string(element.count) + " of the element " + inQuotes(element.name),
                        error.allowed());
  return named.at(error.location());
}

template <class Numbers, class ReadRow>
void forEachPlyRowOf(Numbers numbers, const PlyHeader& header, ReadRow& readRow) {
  for (const PlyElement& element : header.elements) {
    // Rows of nothing take no room in the file, so any number of them may be claimed.
    if (element.properties.empty()) continue;
    for (std::uint64_t row = 0; row < element.count; ++row) {
      try {
        readRow(numbers, element);
      } catch (const Error& error) {
        throw inPlyRow(error, element, row);
      }
    }
  }
  if (!numbers.atEnd())
    throw ioError("the file goes on behind what its header announces", "as many rows as the header says")
        .at(numbers.place());
}

}  // namespace detail

/// Calls readRow(numbers, element) for each row, in the file's order; it must take all numbers of the row.
/// Errors that it throws gain the row. Throws an io Error if the file ends before or goes on behind what its
/// header announces.
template <class ReadRow>
void forEachPlyRow(std::string_view content, const PlyHeader& header, ReadRow&& readRow) {
  const std::string_view body = content.substr(header.size);
  if (header.encoding == PlyEncoding::kAscii)
    return detail::forEachPlyRowOf(PlyAsciiNumbers(body, header.lines + 1), header, readRow);
  const bool littleEndian = header.encoding == PlyEncoding::kLittleEndian;
  detail::forEachPlyRowOf(PlyBinaryNumbers(body, littleEndian), header, readRow);
}

}  // namespace weir
