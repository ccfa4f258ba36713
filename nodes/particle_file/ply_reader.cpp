#include "nodes/particle_file/ply_reader.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "nodes/particle_file/particle_columns.h"
#include "nodes/particle_file/ply_header.h"

namespace weir {

namespace {

/// The element that holds the points.
constexpr std::string_view kVertex = "vertex";

/// The numbers of the data of an ASCII file, one after the other.
class AsciiNumbers {
 public:
  AsciiNumbers(std::string_view data, int line) : rest_(data), line_(line) {}

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
  std::uint64_t mostNumbersLeft(std::size_t) const { return rest_.size() / 2 + 1; }
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
class BinaryNumbers {
 public:
  BinaryNumbers(std::string_view data, bool littleEndian)
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
  std::uint64_t mostNumbersLeft(std::size_t bytesEach) const { return rest_.size() / bytesEach; }
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

std::vector<std::string> namesOf(const PlyElement& element) {
  std::vector<std::string> names;
  for (const PlyProperty& property : element.properties) names.push_back(property.name);
  return names;
}

/// x, y, z, vx, vy and vz must be single numbers with a fraction.
void checkTypes(const PlyElement& vertex, const ParticleColumns& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const PlyProperty& property = vertex.properties[i];
    if (columns.slot(i) && (property.lengthType || !isFloat(property.type)))
      throw ioError(inQuotes(property.name) + (property.lengthType ? " is a list" : " is of an integer type"),
                    "property float or property double")
          .at({.line = property.line, .column = 1});
  }
}

/// Reads the data of one file from its numbers, which are AsciiNumbers or BinaryNumbers.
template <class Numbers>
class DataReader {
 public:
  DataReader(Numbers numbers, const ParticleColumns& columns)
      : numbers_(std::move(numbers)), columns_(columns) {}

  ParticleData read(const std::vector<PlyElement>& elements) {
    for (const PlyElement& element : elements)
      // Rows of nothing take no room in the file, so any number of them may be claimed.
      if (!element.properties.empty()) readElement(element);
    if (!numbers_.atEnd())
      throw ioError("the file goes on behind what its header announces", "as many rows as the header says")
          .at(numbers_.place());
    return std::move(data_);
  }

 private:
  void readElement(const PlyElement& element) {
    const bool isVertex = element.name == kVertex;
    for (std::uint64_t row = 0; row < element.count; ++row) {
      try {
        isVertex ? readVertex(element) : skipRow(element);
      } catch (const Error& error) {
        throw inRow(error, element, row);
      }
    }
  }

  void readVertex(const PlyElement& vertex) {
    ParticleRow row{};
    for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
      const PlyProperty& property = vertex.properties[i];
      const auto slot = columns_.slot(i);
      if (!slot) {
        skip(property);
        continue;
      }
      row[*slot] = static_cast<float>(numbers_.next(property.type));
      if (!std::isfinite(row[*slot]))
        throw ioError(inQuotes(property.name) + " is not finite", "a finite single-precision number")
            .at(numbers_.place());
    }
    addParticle(row, data_);
  }

  void skipRow(const PlyElement& element) {
    for (const PlyProperty& property : element.properties) skip(property);
  }

  void skip(const PlyProperty& property) {
    if (!property.lengthType) return numbers_.skip(property.type);
    const double length = numbers_.next(*property.lengthType);
    if (!(length >= 0) || length != std::floor(length))
      throw ioError("the list " + inQuotes(property.name) + " has no valid length", "an integer from 0 on")
          .at(numbers_.place());
    if (length > static_cast<double>(numbers_.mostNumbersLeft(sizeOf(property.type))))
      throw ioError("the file ends too early: the list " + inQuotes(property.name) +
                    " is longer than the file")
          .at(numbers_.place());
    for (auto left = static_cast<std::uint64_t>(length); left > 0; --left) numbers_.skip(property.type);
  }

  static Error inRow(const Error& error, const PlyElement& element, std::uint64_t row) {
    Error named = ioError(error.message() + ", in row " + std::to_string(row) + " of " +
                              std::to_string(element.count) + " of the element " + inQuotes(element.name),
                          error.allowed());
    return named.at(error.location());
  }

  Numbers numbers_;
  const ParticleColumns& columns_;
  ParticleData data_;
};

ParticleData readPly(std::string_view content) {
  const PlyHeader header = readPlyHeader(content);
  const auto vertex = std::find_if(header.elements.begin(), header.elements.end(),
                                   [](const PlyElement& element) { return element.name == kVertex; });
  if (vertex == header.elements.end()) throw ioError("there is no element 'vertex'", "an element 'vertex'");
  const ParticleColumns columns(namesOf(*vertex));
  checkTypes(*vertex, columns);

  const std::string_view body = content.substr(header.size);
  ParticleData data =
      header.encoding == PlyEncoding::kAscii
          ? DataReader(AsciiNumbers(body, header.lines + 1), columns).read(header.elements)
          : DataReader(BinaryNumbers(body, header.encoding == PlyEncoding::kLittleEndian), columns)
                .read(header.elements);
  if (data.positions.empty()) throw ioError("the element 'vertex' has no rows", "one row or more");
  data.unused = columns.unused();
  return data;
}

}  // namespace

ParticleData PlyReader::read(const std::filesystem::path& file) const {
  const std::string content = readParticleFile(file);
  try {
    return readPly(content);
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace weir
