#include "framework/geometry/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir {

namespace {

struct TypeName {
  std::string_view name, sizedName;
  std::size_t size;
};
/// In the order of PlyType.
constexpr std::array<TypeName, 8> kTypes{TypeName{"char", "int8", 1},     TypeName{"uchar", "uint8", 1},
                                         TypeName{"short", "int16", 2},   TypeName{"ushort", "uint16", 2},
                                         TypeName{"int", "int32", 4},     TypeName{"uint", "uint32", 4},
                                         TypeName{"float", "float32", 4}, TypeName{"double", "float64", 8}};

std::vector<std::string_view> words(std::string_view line) {
  constexpr std::string_view kBlanks = " \t";
  std::vector<std::string_view> all;
  for (std::size_t at = line.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    all.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(kBlanks, end);
  }
  return all;
}

class HeaderReader {
 public:
  explicit HeaderReader(std::string_view content) : content_(content) {}

  PlyHeader read() {
    if (nextLine() != "ply") throw error("the file does not begin with 'ply'", "a PLY file");
    while (true) {
      const std::string_view line = nextLine();
      const auto parts = words(line);
      if (parts.empty() || parts[0] == "comment" || parts[0] == "obj_info") continue;
      if (line == "end_header") break;
      if (parts[0] == "format")
        readFormat(parts);
      else if (parts[0] == "element")
        readElement(parts);
      else if (parts[0] == "property")
        readProperty(parts);
      else
        throw error("found " + inQuotes(line), "format, comment, obj_info, element, property or end_header");
    }
    if (!hasFormat_) throw error("the header has no line 'format'", kFormats);
    return std::move(header_);
  }

 private:
  static constexpr const char* kFormats =
      "format ascii 1.0, format binary_little_endian 1.0 or format binary_big_endian 1.0";

  /// Without the line feed, and the carriage return before it.
  std::string_view nextLine() {
    ++header_.lines;
    const std::string_view rest = content_.substr(header_.size);
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos)
      throw error(
          header_.lines == 1 ? "the file does not begin with 'ply'" : "the file ends within its header",
          header_.lines == 1 ? "a PLY file" : "a line 'end_header' behind the header");
    header_.size += end + 1;
    const std::string_view line = rest.substr(0, end);
    return !line.empty() && line.back() == '\r' ? line.substr(0, line.size() - 1) : line;
  }

  Error error(std::string what, std::string allowed) const {
    return ioError(std::move(what), std::move(allowed)).at({.line = header_.lines, .column = 1});
  }

  void readFormat(const std::vector<std::string_view>& parts) {
    const auto names =
        std::to_array<std::string_view>({"ascii", "binary_little_endian", "binary_big_endian"});
    const auto found = parts.size() == 3 ? std::find(names.begin(), names.end(), parts[1]) : names.end();
    if (found == names.end() || parts[2] != "1.0" || hasFormat_)
      throw error(hasFormat_ ? "there is a second line 'format'" : "the format is not known", kFormats);
    header_.encoding = static_cast<PlyEncoding>(found - names.begin());
    hasFormat_ = true;
  }

  void readElement(const std::vector<std::string_view>& parts) {
    PlyElement element;
    const bool complete = parts.size() == 3;
    const char* end = complete ? parts[2].data() + parts[2].size() : nullptr;
    const auto result = complete ? std::from_chars(parts[2].data(), end, element.count)
                                 : std::from_chars_result{nullptr, std::errc::invalid_argument};
    if (result.ec != std::errc() || result.ptr != end)
      throw error("the element has no name and count", "element NAME COUNT, with a count from 0 on");
    element.name = parts[1];
    for (const PlyElement& other : header_.elements)
      if (other.name == element.name)
        throw error("there are two elements " + inQuotes(element.name), "one element of each name");
    header_.elements.push_back(std::move(element));
  }

  void readProperty(const std::vector<std::string_view>& parts) {
    if (header_.elements.empty())
      throw error("a property stands before the first element", "an element first");
    PlyProperty property{.name = std::string(parts.back()), .lengthType = {}, .line = header_.lines};
    if (parts.size() == 5 && parts[1] == "list") {
      property.lengthType = typeOf(parts[2]);
      if (isFloat(*property.lengthType))
        throw error("the length of the list " + inQuotes(property.name) + " is not an integer",
                    "an integer type");
      property.type = typeOf(parts[3]);
    } else if (parts.size() == 3) {
      property.type = typeOf(parts[1]);
    } else {
      throw error("the property cannot be understood", "property TYPE NAME, or property list TYPE TYPE NAME");
    }
    header_.elements.back().properties.push_back(std::move(property));
  }

  PlyType typeOf(std::string_view name) const {
    for (std::size_t i = 0; i < kTypes.size(); ++i)
      if (name == kTypes[i].name || name == kTypes[i].sizedName) return static_cast<PlyType>(i);
    throw error("found the type " + inQuotes(name), "char, uchar, short, ushort, int, uint, float or double");
  }

  std::string_view content_;
  PlyHeader header_;
  bool hasFormat_ = false;
};

}  // namespace

std::size_t sizeOf(PlyType type) {
  return kTypes[static_cast<std::size_t>(type)].size;
}

PlyHeader readPlyHeader(std::string_view content) {
  return HeaderReader(content).read();
}

}  // namespace weir
