#include "apps/studio/session/packet.h"

#include <bit>

#include "framework/scene/scene_file.h"

namespace weir::studio {

namespace {

static_assert(std::endian::native == std::endian::little, "packets are little-endian");

constexpr std::size_t kAlignment = 8;

std::size_t aligned(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace

std::int64_t PacketWriter::addBytes(const char* bytes, std::size_t count) {
  payload_.resize(aligned(payload_.size()));
  const auto offset = static_cast<std::int64_t>(payload_.size());
  payload_.append(bytes, count);
  return offset;
}

Packet PacketWriter::finish(const Value& header) const {
  std::string text = writeJsonLine(header);
  std::uint32_t length = 0;
  text.resize(aligned(text.size() + sizeof length) - sizeof length, ' ');
  length = static_cast<std::uint32_t>(text.size());
  auto packet = std::make_shared<std::string>(reinterpret_cast<const char*>(&length), sizeof length);
  packet->reserve(sizeof length + text.size() + payload_.size());
  *packet += text;
  *packet += payload_;
  return packet;
}

}  // namespace weir::studio
