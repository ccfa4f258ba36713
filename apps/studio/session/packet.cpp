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
  /// Writes a number in 16 bits to every stride-th place; what is no number is 0. Such a loop is vectorised,
  /// which counts: it runs while the simulation waits.
  template <class Numbers>
  void place(const Numbers& numbers, std::size_t count, std::uint16_t* to, std::size_t stride) const {
    const float size = high - low;  // infinite where a simulation has diverged
    if (!(size > 0) || !std::isfinite(size)) return;
    constexpr float kMost = std::numeric_limits<float>::max();
    for (std::size_t i = 0; i < count; ++i) {
      const float value = std::abs(numbers(i)) <= kMost ? numbers(i) : low;
      to[i * stride] = static_cast<std::uint16_t>(static_cast<int>((value - low) / size * kSteps + 0.5f));
    }
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
  Quantized result{range.low, range.high, std::vector<std::uint16_t>(values.size())};
  range.place([&](std::size_t i) { return values[i]; }, values.size(), result.values.data(), 1);
  return result;
}

QuantizedPoints quantize(std::span<const Vec3f> points) {
  constexpr std::size_t kAxes = 3;
  Range x, y, z;
  for (const Vec3f& p : points) x.add(p.x), y.add(p.y), z.add(p.z);
  x.close(), y.close(), z.close();
  QuantizedPoints result{
      {x.low, y.low, z.low}, {x.high, y.high, z.high}, std::vector<std::uint16_t>(kAxes * points.size())};
  std::uint16_t* to = result.values.data();
  x.place([&](std::size_t i) { return points[i].x; }, points.size(), to, kAxes);
  y.place([&](std::size_t i) { return points[i].y; }, points.size(), to + 1, kAxes);
  z.place([&](std::size_t i) { return points[i].z; }, points.size(), to + 2, kAxes);
  return result;
}

}  // namespace weir::studio
