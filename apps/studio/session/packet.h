// What the studio streams to viewers: frames of particles and the meshes of a scene, as bytes.
//
// A packet is: the length of its header in bytes (u32), the header (JSON, padded with spaces so that what
// follows starts at a multiple of 8), then arrays. All numbers are little-endian; offsets in the header count
// from the first byte behind it. apps/studio/PROTOCOL.md lists the headers.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/value.h"
#include "framework/base/vec.h"

namespace weir::studio {

using Packet = std::shared_ptr<const std::string>;

/// Collects arrays, and then makes a packet of them.
class PacketWriter {
 public:
  /// Appends elements and returns their offset, a multiple of 8.
  template <class T>
  std::int64_t add(std::span<const T> elements) {
    return addBytes(reinterpret_cast<const char*>(elements.data()), elements.size_bytes());
  }
  Packet finish(const Value& header) const;

 private:
  std::int64_t addBytes(const char* bytes, std::size_t count);

  std::string payload_;
};

/// Some numbers in 16 bits each: low + (high - low)·u/65535. What is no number is 0.
struct Quantized {
  float low = 0, high = 0;
  std::vector<std::uint16_t> values;
};
Quantized quantize(std::span<const float> values);

/// Points in 3·16 bits, within their bounds: off by at most half of (high - low)/65535 in each direction.
struct QuantizedPoints {
  Vec3f low{}, high{};
  std::vector<std::uint16_t> values;  ///< x, y, z of each
};
QuantizedPoints quantize(std::span<const Vec3f> points);

}  // namespace weir::studio
