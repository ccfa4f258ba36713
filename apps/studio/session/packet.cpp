#include "apps/studio/session/packet.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "framework/scene/scene_file.h"

namespace weir::studio {

namespace {

static_assert(std::endian::native == std::endian::little, "packets are little-endian");

constexpr std::size_t kAlignment = 8;
constexpr float kSteps = 65535;

std::size_t aligned(std::size_t bytes) {
  return (bytes + kAlignment - 1) / kAlignment * kAlignment;
}

struct Range {
  float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();

  void add(float value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value), high = std::max(high, value);
  }
  void close() {
    if (low > high) low = high = 0;
  }
  std::uint16_t place(float value) const {
    const float size = high - low;  // infinite where a simulation has diverged
    if (!std::isfinite(value) || !(size > 0) || !std::isfinite(size)) return 0;
    // Not lround, which is a call for each number: this runs while the simulation waits.
    return static_cast<std::uint16_t>((value - low) / size * kSteps + 0.5f);
  }
};

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

Quantized quantize(std::span<const float> values) {
  Range range;
  for (const float value : values) range.add(value);
  range.close();
  Quantized result{range.low, range.high, {}};
  result.values.reserve(values.size());
  for (const float value : values) result.values.push_back(range.place(value));
  return result;
}

QuantizedPoints quantize(std::span<const Vec3f> points) {
  Range x, y, z;
  for (const Vec3f& p : points) x.add(p.x), y.add(p.y), z.add(p.z);
  x.close(), y.close(), z.close();
  QuantizedPoints result{{x.low, y.low, z.low}, {x.high, y.high, z.high}, {}};
  result.values.reserve(3 * points.size());
  for (const Vec3f& p : points) {
    result.values.push_back(x.place(p.x));
    result.values.push_back(y.place(p.y));
    result.values.push_back(z.place(p.z));
  }
  return result;
}

}  // namespace weir::studio
