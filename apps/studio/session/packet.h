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

#include "framework/base/value.h"

namespace weir::studio {

using Packet = std::shared_ptr<const std::string>;

/// Collects arrays, and then makes a packet of them. One that is used again has its memory already.
class PacketWriter {
 public:
  /// Appends elements and returns their offset, a multiple of 8.
  template <class T>
  std::int64_t add(std::span<const T> elements) {
    return addBytes(reinterpret_cast<const char*>(elements.data()), elements.size_bytes());
  }
  Packet finish(const Value& header) const;
  void clear() { payload_.clear(); }

 private:
  std::int64_t addBytes(const char* bytes, std::size_t count);

  std::string payload_;
};

}  // namespace weir::studio
