#include "apps/studio/session/packet.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "apps/studio/session/recording.h"
#include "framework/scene/scene_file.h"

namespace weir::studio {
namespace {

TEST(Packets, HoldHeaderAndArraysWhereTheyAreSaidToBe) {
  PacketWriter writer;
  const std::vector<std::uint16_t> small{1, 2, 3};
  const std::vector<float> floats{0.5f, -2};
  Value header = Value::object();
  header["small"] = writer.add(std::span<const std::uint16_t>(small));
  header["floats"] = writer.add(std::span<const float>(floats));
  const Packet packet = writer.finish(header);
  std::uint32_t length = 0;
  std::memcpy(&length, packet->data(), sizeof length);
  const std::size_t start = sizeof length + length;
  EXPECT_EQ(start % 8, 0u);
  const Value read = parseJson(packet->substr(sizeof length, length), "header");
  float second = 0;
  std::memcpy(&second, packet->data() + start + read.find("floats")->asInt() + sizeof(float), sizeof second);
  EXPECT_EQ(second, -2);
  EXPECT_EQ(read.find("floats")->asInt() % 8, 0);
}

TEST(Recordings, ForgetEverySecondFrameWhereTheyGrowTooLarge) {
  Recording recording(2000);
  const Packet packet = std::make_shared<const std::string>(100, 'x');
  for (std::int64_t frame = 0; frame <= 100; ++frame) recording.add(frame, packet);
  EXPECT_LE(recording.bytes(), 2000);
  EXPECT_GE(recording.size(), 5u);
  EXPECT_NE(recording.nearest(0), nullptr);
  recording.clear();
  EXPECT_EQ(recording.bytes(), 0);
  EXPECT_EQ(recording.nearest(0), nullptr);
  const Packet other = std::make_shared<const std::string>("y");
  recording.add(4, packet);
  recording.add(10, other);
  EXPECT_EQ(recording.nearest(6), packet);
  EXPECT_EQ(recording.nearest(8), other);
  EXPECT_EQ(recording.nearest(999), other);
}

}  // namespace
}  // namespace weir::studio
