// Particles leave one set and come to another, as its own or as its halo.
#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "framework/particles/pack_layout.h"
#include "framework/particles/particle_set.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

using Ids = std::vector<std::int64_t>;

class ExchangeTest : public OnDevice {
 protected:
  static constexpr int kCount = 10, kAttributes = 9;  // more than one launch packs

  ExchangeTest() {
    std::vector<Vec3f> positions, velocities;
    for (int i = 0; i < kCount; ++i) {
      positions.push_back({float(i), 1, 2});
      velocities.push_back({0, float(i), -1});
    }
    batch.assign(*device, positions, velocities);
    for (int k = 0; k < kAttributes; ++k) {
      std::vector<float> numbers;
      for (int i = 0; i < kCount; ++i) numbers.push_back(float(100 * k + i));
      source.add<float>({.name = nameOf(k), .unit = "", .doc = ""});
      all.push_back(numbers);
    }
    source.add<float>({.name = "derived", .unit = "", .doc = "", .derived = true});
    source.append(batch);
    for (int k = 0; k < kAttributes; ++k) source.get<float>(nameOf(k)).assign(all[std::size_t(k)]);
  }

  static std::string nameOf(int k) { return "a" + std::to_string(k); }
  void addAttributes(ParticleSet& set) const {
    for (int k = 0; k < kAttributes; ++k) set.add<float>({.name = nameOf(k), .unit = "", .doc = ""});
  }
  ArrayView<const std::byte> packed(const PackLayout& layout, const std::vector<int>& indices) {
    const Array<int> onDevice(*device, indices);
    source.pack(layout, onDevice.view(), buffer);
    return std::as_const(buffer).view();
  }

  ParticleBatch batch;
  ParticleSet source{*device};
  std::vector<std::vector<float>> all;
  Array<std::byte> buffer{*device};
};
WEIR_ON_EVERY_DEVICE(ExchangeTest);

TEST_P(ExchangeTest, PackedParticlesBringAllThatTheyHad) {
  ParticleSet target(*device);
  addAttributes(target);
  const Attribute<int> own = target.add<int>({.name = "own", .unit = "", .doc = ""});
  target.append(batch);
  own.assign(std::vector<int>(kCount, 7));
  const PackLayout layout(source);
  // Position, velocity, id, and what was added.
  EXPECT_EQ(layout.bytesOfOne(), 12 + 12 + 8 + 4 * kAttributes);
  // Before anybody has moved them.
  source.move({{}, 0.5f});
  const std::vector<int> chosen{7, 2, 9};
  const ArrayView<const std::byte> bytes = packed(layout, chosen);
  EXPECT_EQ(bytes.size, layout.bytesOf(3));
  target.appendPacked(layout, bytes);
  ASSERT_EQ(target.refreshCount(), kCount + 3);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const auto i = std::size_t(chosen[k]), at = kCount + k;
    EXPECT_EQ(target.positions().toHost(kCount + 3)[at], (Vec3f{float(i), 1 + 0.5f * float(i), 1.5f}));
    EXPECT_EQ(target.velocities().toHost(kCount + 3)[at], (Vec3f{0, float(i), -1}));
    EXPECT_EQ(target.ids().toHost(kCount + 3)[at], std::int64_t(i));
    for (int a = 0; a < kAttributes; ++a)
      EXPECT_EQ(target.get<float>(nameOf(a)).toHost(kCount + 3)[at], all[std::size_t(a)][i]);
  }
  std::vector<int> expected(kCount, 7);
  expected.resize(kCount + 3);
  EXPECT_EQ(own.toHost(kCount + 3), expected);
  // Those who came have ids of their own.
  target.append(batch);
  EXPECT_EQ(target.ids().toHost(kCount + 4).back(), kCount);
}

TEST_P(ExchangeTest, WhoLeavesIsGoneAndTheLastOnesTakeTheirPlaces) {
  source.move({{}, 0.5f});
  source.remove({9, 0, 4});
  ASSERT_EQ(source.refreshCount(), kCount - 3);
  EXPECT_EQ(source.count().bound, kCount - 3);
  EXPECT_EQ(source.ids().toHost(kCount - 3), (Ids{7, 1, 2, 3, 8, 5, 6}));
  EXPECT_EQ(source.get<float>("a8").toHost(2), (std::vector<float>{807, 801}));
  EXPECT_EQ(source.positions().toHost(1).front(), (Vec3f{7, 4.5f, 1.5f}));
  source.remove({});
  EXPECT_EQ(source.refreshCount(), kCount - 3);
  source.remove({0, 1, 2, 3, 4, 5, 6});
  EXPECT_EQ(source.refreshCount(), 0);
}

TEST_P(ExchangeTest, AHaloStandsBehindTheOwnedAndIsNotOfTheSet) {
  ParticleSet target(*device);
  addAttributes(target);
  target.append(batch);
  const PackLayout layout(source);
  const HaloRange first = target.appendHalo(layout, packed(layout, {3, 5}));
  const HaloRange second = target.appendHalo(layout, packed(layout, {8}));
  EXPECT_EQ(first.first, 0);
  EXPECT_EQ(second.first, 2);
  EXPECT_EQ(target.refreshCount(), kCount);
  EXPECT_EQ(target.count().bound, kCount);
  EXPECT_EQ(target.countWithHalo().get(), kCount + 3);
  EXPECT_EQ(target.ids().toHost(kCount + 3), (Ids{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 3, 5, 8}));
  EXPECT_EQ(target.get<float>("a8").toHost(kCount + 3).back(), 808);

  StateArrays arrays;
  target.save(StateWriter(arrays));
  EXPECT_EQ(arrays.at("id").rows, kCount);
  ParticleSet restored(*device);
  addAttributes(restored);
  restored.restore(StateReader(arrays));
  EXPECT_EQ(restored.haloCount(), 0);

  // One attribute anew, of some; the others stay as they are.
  const PackLayout one(source, {"a4"});
  const Version before = target.get<float>("a4").version(), other = target.get<float>("a5").version();
  source.get<float>("a4").assign(std::vector<float>(kCount, -1));
  target.refreshHalo(one, packed(one, {8}), second);
  EXPECT_FALSE(before.isPresent());
  EXPECT_TRUE(other.isPresent());
  const std::vector<float> numbers = target.get<float>("a4").toHost(kCount + 3);
  EXPECT_EQ(std::vector<float>(numbers.end() - 4, numbers.end()), (std::vector<float>{0, 403, 405, -1}));
}

TEST_P(ExchangeTest, AHaloIsGoneWhenTheOwnedAreRearranged) {
  const PackLayout layout(source);
  ParticleSet target(*device);
  addAttributes(target);
  const Array<int> order(*device, std::vector<int>{9, 8, 7, 6, 5, 4, 3, 2, 1, 0});
  const std::vector<std::function<void()>> changes{
      [&] { target.append(batch); },
      [&] { target.appendPacked(layout, packed(layout, {1})); },
      [&] { target.permute(order.view()); },
      [&] { target.remove({1}); },
      [&] { target.dropHalo(); },
      [&] { target.clear(); },
  };
  for (const auto& change : changes) {
    target.clear();
    target.append(batch);
    target.appendHalo(layout, packed(layout, {3, 5}));
    ASSERT_EQ(target.haloCount(), 2);
    // Moving belongs to the owned alone.
    target.move({{}, 1});
    EXPECT_EQ(target.positions().toHost(kCount + 1)[kCount], (Vec3f{3, 1, 2}));
    ASSERT_EQ(target.haloCount(), 2);
    change();
    EXPECT_EQ(target.haloCount(), 0);
    EXPECT_EQ(target.countWithHalo().bound, target.count().bound);
  }
}

TEST_P(ExchangeTest, WhatDoesNotFitIsRefused) {
  const PackLayout layout(source);
  ParticleSet target(*device);
  EXPECT_CONTAINS(errorOf([&] { target.appendPacked(layout, packed(layout, {1})); }).what(),
                  "no attribute 'a0' of type float");
  addAttributes(target);
  const ArrayView<const std::byte> bytes = packed(layout, {1, 2});
  EXPECT_CONTAINS(errorOf([&] {
                    target.appendPacked(layout, {bytes.data, bytes.size - 4});
                  }).what(),
                  "a multiple of 68");
  const HaloRange halo = target.appendHalo(layout, bytes);
  EXPECT_CONTAINS(errorOf([&] { target.refreshHalo(layout, packed(layout, {1}), halo); }).what(),
                  "for 2 of the halo");
  EXPECT_CONTAINS(errorOf([&] { PackLayout(source, {"a10"}); }).what(), "no attribute 'a10'");
  EXPECT_CONTAINS(errorOf([&] { PackLayout(target, {"id"}).checkSame("id int", "rank 3"); }).what(),
                  "rank 3");
  EXPECT_EQ(PackLayout(target, {"position", "id"}).describe(), "position vec3, id int64");
}

}  // namespace
}  // namespace weir::test
