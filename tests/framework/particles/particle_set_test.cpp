// Putting particles into another order, few of them and so many that attributes go one after another.
#include "framework/particles/particle_set.h"

#include <gtest/gtest.h>

#include "framework/particles/pack_layout.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

using ParticleSetTest = OnDevice;
WEIR_ON_EVERY_DEVICE(ParticleSetTest);

/// Values that tell the particle, its attribute and its component.
Vec3f vectorOf(int i, float attribute) {
  return {float(i), attribute, float(i % 1000) + 0.25f};
}

TEST_P(ParticleSetTest, AllAttributesTravelWithTheirParticles) {
  for (const std::int64_t count : {std::int64_t{1000}, ParticleSet::kFew + 1000}) {
    ParticleSet particles(*device);
    const Attribute<Vec3f> carried = particles.add<Vec3f>({.name = "carried", .unit = "", .doc = ""});
    const Attribute<float> share = particles.add<float>({.name = "share", .unit = "", .doc = ""});
    const Attribute<float> heat = particles.add<float>({.name = "heat", .unit = "", .doc = ""});
    const Attribute<Mat3f> tensor = particles.add<Mat3f>({.name = "stress", .unit = "", .doc = ""});
    const Attribute<int> phase = particles.add<int>({.name = "phase", .unit = "", .doc = ""});
    const auto stamp = particles.add<std::int64_t>({.name = "stamp", .unit = "", .doc = ""});
    particles.add<float>({.name = "derived", .unit = "", .doc = "", .derived = true});
    const auto n = static_cast<std::size_t>(count);
    std::vector<Vec3f> positions, velocities, third;
    std::vector<float> shares, heats;
    std::vector<Mat3f> tensors;
    std::vector<int> phases;
    std::vector<std::int64_t> stamps;
    for (int i = 0; i < count; ++i) {
      positions.push_back(vectorOf(i, 1));
      velocities.push_back(vectorOf(i, 2));
      third.push_back(vectorOf(i, 3));
      shares.push_back(float(i) + 0.5f);
      heats.push_back(-float(i));
      tensors.push_back({vectorOf(i, 4), vectorOf(i, 5), vectorOf(i, 6)});
      phases.push_back(3 * i);
      stamps.push_back((std::int64_t{1} << 40) * (i % 5) + i);
    }
    ParticleBatch batch;
    batch.assign(*device, positions, velocities);
    particles.append(batch);
    ASSERT_EQ(particles.capacity() > ParticleSet::kFew, count > ParticleSet::kFew);
    carried.assign(third);
    share.assign(shares);
    heat.assign(heats);
    tensor.assign(tensors);
    phase.assign(phases);
    stamp.assign(stamps);

    std::vector<int> order(n);
    for (std::size_t k = 0; k < n; ++k) order[k] = static_cast<int>((k * 7 + 3) % n);
    const Array<int> onDevice(*device, order);
    for (int times = 0; times < 2; ++times) {
      particles.permute(onDevice.view());
      // What is in the scratch memory does not matter.
      const Lease<Vec3f> room = particles.leaseVectors();
      device->fillBytes(room.data(), 0, n * sizeof(Vec3f));
    }
    const std::vector<std::int64_t> ids = particles.ids().toHost(count);
    const auto found = [&](const auto& values, const auto& expected) {
      const auto ordered = values.toHost(count);
      for (std::size_t k = 0; k < n; ++k)
        if (!(ordered[k] == expected[static_cast<std::size_t>(ids[k])])) return false;
      return true;
    };
    EXPECT_EQ(ids[5], order[static_cast<std::size_t>(order[5])]);
    EXPECT_TRUE(found(particles.positions(), positions));
    EXPECT_TRUE(found(particles.velocities(), velocities));
    EXPECT_TRUE(found(carried, third));
    EXPECT_TRUE(found(share, shares));
    EXPECT_TRUE(found(heat, heats));
    EXPECT_TRUE(found(tensor, tensors));
    EXPECT_TRUE(found(phase, phases));
    EXPECT_TRUE(found(stamp, stamps));
  }
}

TEST_P(ParticleSetTest, IdsGoOnWhereThirtyTwoBitsEnd) {
  constexpr std::int64_t kGiven = std::int64_t{1} << 31;
  ParticleSet particles(*device);
  particles.continueIdsFrom(kGiven - 1);
  ParticleBatch batch;
  batch.assign(*device, std::vector<Vec3f>(2), Vec3f{});
  particles.append(batch);
  particles.append(batch);
  EXPECT_EQ(particles.ids().toHost(4),
            (std::vector<std::int64_t>{kGiven - 1, kGiven, kGiven + 1, kGiven + 2}));
  EXPECT_EQ(particles.nextId(), kGiven + 3);
  StateArrays arrays;
  particles.refreshCount();
  particles.save(StateWriter(arrays));
  EXPECT_EQ(arrays.at("id").kind, StateKind::kInt64);
  ParticleSet other(*device);
  other.restore(StateReader(arrays));
  other.append(batch);
  EXPECT_EQ(other.ids().toHost(6).back(), kGiven + 4);
}

TEST_P(ParticleSetTest, RefusesCheckpointsWithIdsOf32Bits) {
  ParticleSet particles(*device);
  ParticleBatch batch;
  batch.assign(*device, std::vector<Vec3f>(2), Vec3f{});
  particles.append(batch);
  StateArrays arrays;
  particles.save(StateWriter(arrays));
  arrays.erase("id");
  StateWriter(arrays).put("id", std::span<const int>(std::vector<int>{0, 1}));
  const Error error = errorOf([&] { particles.restore(StateReader(arrays)); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(error.message(), "'id' is not what this program would write");
}

TEST_P(ParticleSetTest, WhatIsInternalTravelsAndIsNeitherShownNorSaved) {
  ParticleSet particles(*device);
  ParticleBatch batch;
  batch.assign(*device, std::vector<Vec3f>(2), Vec3f{});
  particles.append(batch);
  const Attribute<float> way = particles.add<float>({.name = "way", .internal = true});
  way.assign(std::vector<float>{1, 2});
  const Array<int> order(*device, std::vector<int>{1, 0});
  particles.permute(order.view());
  EXPECT_EQ(way.toHost(2), (std::vector<float>{2, 1}));
  EXPECT_EQ(particles.attributes().size(), 3u);  // position, velocity, id
  EXPECT_EQ(particles.allAttributes().back().name, "way");
  EXPECT_EQ(PackLayout(particles).attributes().back().name, "way");
  StateArrays arrays;
  particles.save(StateWriter(arrays));
  EXPECT_FALSE(arrays.contains("way"));
  particles.restore(StateReader(arrays));
  EXPECT_EQ(particles.bound(), 2);
}

/// Particles with an attribute: the heat of particle i is `heat` + i.
ParticleBatch hotBatch(Device& device, int count, float heat, AttributeInfo info = {.name = "heat"}) {
  std::vector<Vec3f> at;
  std::vector<float> heats;
  for (int i = 0; i < count; ++i) at.push_back(vectorOf(i, heat)), heats.push_back(heat + float(i));
  ParticleBatch batch;
  batch.assign(device, at, Vec3f{});
  info.type = AttributeType::kFloat;
  batch.attributes.push_back({info, Array<float>(device, heats)});
  return batch;
}

TEST_P(ParticleSetTest, TakesTheAttributesThatABatchBrings) {
  ParticleSet particles(*device);
  ParticleBatch plain;
  plain.assign(*device, std::vector<Vec3f>(3), Vec3f{});
  particles.append(plain);
  particles.append(hotBatch(*device, 5000, 100));  // more than there was room for
  particles.append(plain);
  std::vector<float> expected(3);
  for (int i = 0; i < 5000; ++i) expected.push_back(100 + float(i));
  expected.resize(5006);
  EXPECT_EQ(particles.get<float>("heat").toHost(5006), expected);

  // Some of a batch, in another order, of which the device alone knows how many.
  const Array<int> order(*device, std::vector<int>{3, 1, 2}), kept(*device, std::vector<int>{2});
  particles.append(hotBatch(*device, 4, 7), {order.view(), kept.data()});
  EXPECT_EQ(particles.refreshCount(), 5008);
  expected.insert(expected.end(), {10, 8});
  EXPECT_EQ(particles.get<float>("heat").toHost(5008), expected);
}

TEST_P(ParticleSetTest, RefusesAttributesWhoseNamesAreTaken) {
  ParticleSet particles(*device);
  particles.add<float>({.name = "density", .derived = true});
  particles.add<int>({.name = "phase"});
  for (const auto& [name, reason] : {std::pair{"density", "which it computes itself"},
                                     {"phase", "the fluid has one of that name, int"},
                                     {"position", "which every particle has"}}) {
    const Error error = errorOf([&] { particles.append(hotBatch(*device, 4, 1, {.name = name})); });
    EXPECT_EQ(error.kind(), ErrorKind::kScene);
    EXPECT_CONTAINS(error.message(), reason);
    EXPECT_EQ(particles.refreshCount(), 0);
  }
}

TEST_P(ParticleSetTest, MovesWhoeverAsksAndWhateverComesFirst) {
  const FreeMotion motion{{0, -9.8f, 1}, 0.01f};
  for (const int count : {1000, int(ParticleSet::kFew) + 1000}) {
    std::vector<Vec3f> at, velocities, moved, faster;
    for (int i = 0; i < count; ++i) {
      at.push_back(vectorOf(i, 1));
      velocities.push_back(vectorOf(i % 7, 2));
      faster.push_back(velocities.back() + motion.dt * motion.acceleration);
      moved.push_back(at.back() + motion.dt * faster.back());
    }
    ParticleBatch batch;
    batch.assign(*device, at, velocities);
    std::vector<int> order(at.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = int((k * 7 + 3) % order.size());
    const Array<int> onDevice(*device, order);
    for (const bool permuted : {false, true}) {
      ParticleSet particles(*device);
      particles.append(batch);
      particles.move(motion);
      if (permuted) particles.permute(onDevice.view());
      const std::vector<Vec3f> p = particles.positions().toHost(count),
                               v = particles.velocities().toHost(count);
      for (std::size_t k = 0; k < order.size(); ++k) {
        const std::size_t i = permuted ? std::size_t(order[k]) : k;
        // Multiplication and addition may be rounded once or twice.
        ASSERT_LE(length(v[k] - faster[i]), 1e-6f * length(faster[i])) << i;
        ASSERT_LE(length(p[k] - moved[i]), 1e-6f * length(moved[i])) << i;
      }
      // Once.
      EXPECT_FALSE(particles.hasPendingMotion());
      EXPECT_EQ(particles.positions().toHost(count), p);
    }
  }
}

}  // namespace
}  // namespace weir::test
