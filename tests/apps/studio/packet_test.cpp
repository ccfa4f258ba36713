#include "apps/studio/session/packet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

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

TEST(Packets, PointsAreOffByHalfAStepAtMost) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-3, 5);
  std::vector<Vec3f> points;
  for (int i = 0; i < 1000; ++i)
    points.push_back({place(random), 0.01f * place(random), 100 * place(random)});
  const QuantizedPoints q = quantize(std::span<const Vec3f>(points));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto back = [&](float low, float high, std::size_t axis) {
      return low + (high - low) * float(q.values[3 * i + axis]) / 65535;
    };
    const auto step = [](float low, float high) { return 0.51f * (high - low) / 65535; };
    EXPECT_NEAR(back(q.low.x, q.high.x, 0), points[i].x, step(q.low.x, q.high.x));
    EXPECT_NEAR(back(q.low.y, q.high.y, 1), points[i].y, step(q.low.y, q.high.y));
    EXPECT_NEAR(back(q.low.z, q.high.z, 2), points[i].z, step(q.low.z, q.high.z));
  }
}

TEST(Packets, WhatIsNoNumberOrHasNoRangeIsZero) {
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> values{1, NAN, 2, inf, -inf};
  const Quantized q = quantize(std::span<const float>(values));
  EXPECT_EQ(q.low, 1);
  EXPECT_EQ(q.high, 2);
  EXPECT_EQ(q.values, (std::vector<std::uint16_t>{0, 0, 65535, 0, 0}));
  EXPECT_EQ(quantize(std::span<const float>()).values.size(), 0u);
  const std::vector<float> same{3, 3};
  EXPECT_EQ(quantize(std::span<const float>(same)).values, (std::vector<std::uint16_t>{0, 0}));
}

TEST(Recordings, ForgetEverySecondFrameWhereTheyGrowTooLarge) {
  Recording recording(1000);
  const Packet packet = std::make_shared<const std::string>(100, 'x');
  for (std::int64_t frame = 0; frame <= 100; ++frame) recording.add(frame, packet);
  EXPECT_LE(recording.bytes(), 1000);
  EXPECT_GE(recording.size(), 5u);
  EXPECT_NE(recording.nearest(0), nullptr);
  recording.clear();
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
