// What the header of a PLY file says of the data behind it.
//
// The format: G. Turk, The PLY Polygon File Format, 1994.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"

namespace WEIR_API weir {

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

std::size_t sizeOf(PlyType type);  ///< in a binary file, bytes
inline bool isFloat(PlyType type) {
  return type == PlyType::kFloat32 || type == PlyType::kFloat64;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;   ///< of one number
  std::optional<PlyType> lengthType;  ///< of the number of numbers, if this is a list; an integer type
  int line = 0;                       ///< where it is declared
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< bytes before the data
  int lines = 0;         ///< lines before the data
};

/// Reads the header at the beginning of a file's content. Throws an io Error with a line, but without the
/// file's name.
PlyHeader readPlyHeader(std::string_view content);

}  // namespace weir
