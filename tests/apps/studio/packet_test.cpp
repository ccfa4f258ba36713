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

TEST(Recordings, GoBackToAFrame) {
  KeptStates states(1 << 20);
  EXPECT_EQ(states.lastUpTo(5), nullptr);
  for (const std::int64_t frame : {0, 3, 6}) states.add(frame, std::make_shared<const StateArrays>());
  const auto at = [&](std::int64_t frame) { return states.lastUpTo(frame); };
  EXPECT_EQ(at(5), at(3));
  EXPECT_NE(at(6), at(3));
  EXPECT_EQ(at(100), at(6));
  states.forgetAfter(3);
  EXPECT_EQ(at(100), at(3));
  EXPECT_EQ(states.size(), 2u);
  const std::int64_t bytes = states.bytes();
  states.add(9, std::make_shared<const StateArrays>(
                    StateArrays{{"nodes/a", StateArray{.data = std::vector<std::byte>(500)}}}));
  EXPECT_GT(states.bytes(), bytes + 500);
  states.forgetAfter(8);
  EXPECT_EQ(states.bytes(), bytes);
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
