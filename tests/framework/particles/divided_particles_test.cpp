// A cloud on several ranks: lists are those of one rank, in the same order, whichever axis is the longest and
// also for what has left the box that space was cut for; copies on other ranks are what their owners have.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <utility>
#include <vector>

#include "framework/communication/thread_ranks.h"
#include "framework/neighbors/neighbor_list.h"
#include "framework/particles/divided_particles.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr float kRadius = 0.05f;
constexpr int kCapacity = 128;
constexpr Aabb kEverywhere{{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};

using Ids = std::vector<std::int64_t>;
/// Of each particle, by its id: its neighbours' ids in the order of its list.
using Lists = std::map<std::int64_t, Ids>;

Lists sorted(Lists lists) {
  for (auto& [id, list] : lists) std::sort(list.begin(), list.end());
  return lists;
}

struct Cloud {
  Aabb box;  // that space is cut for
  std::vector<Vec3f> positions;
};

/// Most of them fill the box; the others are in dense drops far beyond its ends and beside it.
Cloud cloudAlong(int axis, int count) {
  Cloud cloud;
  const float scale = std::cbrt(float(count) / 20'000);  // so that all have as many neighbours
  Vec3f size = scale * Vec3f{0.5f, 0.6f, 0.4f};
  size[axis] = scale * 1.4f;
  cloud.box = {{-0.3f, 0.2f, -0.1f}, Vec3f{-0.3f, 0.2f, -0.1f} + size};
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < count; ++i) {
    Vec3f p{unit(random), unit(random), unit(random)};
    if (i % 50 == 0) {
      p = 0.15f * p;
      p[(axis + i / 50 % 2) % 3] += i % 100 == 0 ? 9.0f : -9.0f;
    }
    cloud.positions.push_back(cloud.box.lo + Vec3f{p.x * size.x, p.y * size.y, p.z * size.z});
  }
  return cloud;
}

class DividedParticlesTest : public OnDevice {
 protected:
  struct Part {
    Part(Communicator& ranks, Device& device, const Cloud& cloud)
        : particles(device), list(device), divided(ranks, particles, kRadius) {
      list.configure(kRadius, kCapacity);
      list.orderByIds();
      field = particles.add<float>({.name = "field", .unit = "", .doc = ""});
      const Array<Vec3f> positions(device, cloud.positions);
      divided.cut(cloud.box, {positions.view()});
      list.fitSlab({.own = divided.ownLayers(), .all = divided.allLayers()}, cloud.box,
                   std::ssize(cloud.positions));
      ParticleBatch batch;
      batch.assign(device, cloud.positions, std::vector<Vec3f>(cloud.positions.size()));
      divided.append(batch);
    }

    void search() {
      divided.migrate();
      list.sort(particles, kEverywhere);
      divided.showHalo(list.sortedLayers());
      list.list(particles);
    }

    Ids idsWithHalo() const { return particles.ids().toHost(particles.bound() + particles.haloCount()); }

    ParticleSet particles;
    NeighborList list;
    DividedParticles divided;
    Attribute<float> field;
  };

  /// Calls f(part) on each of some ranks, once it has searched.
  template <class F>
  void onRanks(int ranks, const Cloud& cloud, const F& f) const {
    // Those of all must outlive those of all.
    std::vector<std::unique_ptr<Device>> devices(static_cast<std::size_t>(ranks));
    runOnThreads(ranks, [&](Communicator& communicator) {
      auto& own = devices[static_cast<std::size_t>(communicator.rank())] = openDevice(GetParam());
      Part part(communicator, *own, cloud);
      part.search();
      f(part);
      communicator.sum(0);
    });
  }

  Lists listsOn(int ranks, const Cloud& cloud) const {
    Lists all;
    std::mutex mutex;
    onRanks(ranks, cloud, [&](const Part& part) {
      const Ids ids = part.idsWithHalo();
      const auto lists = part.list.listsOnHost(part.particles.bound());
      const std::lock_guard lock(mutex);
      for (std::size_t i = 0; i < lists.size(); ++i)
        for (const int j : lists[i]) all[ids[i]].push_back(ids[static_cast<std::size_t>(j)]);
    });
    return all;
  }

  /// By the search of undivided particles, in ascending order.
  Lists listsOfOneSet(const Cloud& cloud) const {
    ParticleSet particles(*device);
    ParticleBatch batch;
    batch.assign(*device, cloud.positions, std::vector<Vec3f>(cloud.positions.size()));
    particles.append(batch);
    NeighborList list(*device);
    list.configure(kRadius, kCapacity);
    list.usePortableSearch();
    list.build(particles, kEverywhere);
    const Ids ids = particles.ids().toHost(particles.refreshCount());
    Lists all;
    const auto lists = list.listsOnHost(particles.bound());
    for (std::size_t i = 0; i < lists.size(); ++i)
      for (const int j : lists[i]) all[ids[i]].push_back(ids[static_cast<std::size_t>(j)]);
    return sorted(all);
  }
};

WEIR_ON_EVERY_DEVICE(DividedParticlesTest);

TEST_P(DividedParticlesTest, ListsAreThoseOfOneRankInTheSameOrder) {
  for (int axis = 0; axis < 3; ++axis) {
    const Cloud cloud = cloudAlong(axis, 20'000);
    const Lists one = listsOn(1, cloud);
    EXPECT_TRUE(sorted(one) == listsOfOneSet(cloud)) << "axis " << axis;
    for (const int ranks : {2, 3, 7})
      EXPECT_TRUE(listsOn(ranks, cloud) == one) << ranks << " ranks, axis " << axis;
  }
}

/// On CUDA they are searched for in another way.
TEST_P(DividedParticlesTest, SoAreThoseOfManyParticles) {
  const Cloud cloud = cloudAlong(1, 100'000);
  const Lists one = listsOn(1, cloud);
  EXPECT_TRUE(sorted(one) == listsOfOneSet(cloud));
  EXPECT_TRUE(listsOn(2, cloud) == one);
}

TEST_P(DividedParticlesTest, MoreRanksThanLayersDoNoHarm) {
  Cloud cloud = cloudAlong(2, 3000);
  for (Vec3f& p : cloud.positions) p.z = 0.3f * kRadius;
  cloud.box = {{-0.3f, 0.2f, 0}, {0.2f, 0.8f, kRadius / 2}};
  EXPECT_EQ(listsOn(9, cloud), listsOn(1, cloud));
}

TEST_P(DividedParticlesTest, CopiesAreWhatTheirOwnersHave) {
  const Cloud cloud = cloudAlong(1, 30'000);
  const auto valueOf = [](std::int64_t id) { return 0.5f + float(id); };
  std::mutex mutex;
  std::int64_t copies = 0;
  onRanks(3, cloud, [&](Part& part) {
    const Ids ids = part.idsWithHalo();
    std::vector<float> values(static_cast<std::size_t>(part.particles.capacity()), -1.0f);
    for (std::int64_t i = 0; i < part.particles.bound(); ++i)
      values[std::size_t(i)] = valueOf(ids[std::size_t(i)]);
    part.field.assign(values);
    Array<float> others(part.particles.device(), values);
    part.divided.refresh({"field"});
    part.divided.refresh(others.view());
    const std::vector<float> fields = part.field.toHost(std::ssize(ids)),
                             more = others.toHost(std::ssize(ids));
    const std::vector<Vec3f> positions = part.particles.positions().toHost(std::ssize(ids));
    const std::lock_guard lock(mutex);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ASSERT_EQ(fields[i], valueOf(ids[i]));
      ASSERT_EQ(more[i], valueOf(ids[i]));
      ASSERT_EQ(positions[i], cloud.positions[std::size_t(ids[i])]);
    }
    copies += part.particles.haloCount();
  });
  EXPECT_GT(copies, 1000);
}

/// Ids and positions that rank 0 gathers, and what of the field.
struct Gathered {
  Ids ids;
  std::vector<Vec3f> positions;
  std::vector<float> fields;
};

TEST_P(DividedParticlesTest, WhatIsGatheredStandsInTheSameOrderForAnyNumberOfRanks) {
  const Cloud cloud = cloudAlong(2, 20'000);
  const auto gatheredOn = [&](int ranks) {
    Gathered found;
    onRanks(ranks, cloud, [&](Part& part) {
      std::vector<float> values;
      for (const std::int64_t id : part.particles.ids().toHost(part.particles.bound()))
        values.push_back(2 * float(id));
      part.field.assign(values);
      ParticleSet all(part.particles.device());
      const bool isFirst = part.divided.ranks().rank() == 0;
      for (int turn = 0; turn < 2; ++turn) {  // memory is there the second time
        all.clear();
        part.divided.gather(isFirst ? &all : nullptr);
      }
      if (!isFirst) return;
      EXPECT_EQ(all.nextId(), std::ssize(cloud.positions));
      found = {all.ids().toHost(all.bound()), all.positions().toHost(all.bound()),
               all.get<float>("field").toHost(all.bound())};
    });
    return found;
  };
  const Gathered one = gatheredOn(1);
  ASSERT_EQ(one.ids.size(), cloud.positions.size());
  for (std::size_t i = 0; i < one.ids.size(); ++i) {
    ASSERT_EQ(one.positions[i], cloud.positions[std::size_t(one.ids[i])]);
    ASSERT_EQ(one.fields[i], 2 * float(one.ids[i]));
  }
  for (const int ranks : {2, 3, 7}) {
    const Gathered several = gatheredOn(ranks);
    EXPECT_EQ(several.ids, one.ids) << ranks;
    EXPECT_TRUE(several.positions == one.positions) << ranks;
    EXPECT_EQ(several.fields, one.fields) << ranks;
  }
}

TEST_P(DividedParticlesTest, OfASelectionEachRankTakesItsOwnWithTheIdsOfAll) {
  const Cloud cloud = cloudAlong(0, 5000);
  std::map<std::int64_t, Vec3f> found;
  std::mutex mutex;
  onRanks(3, cloud, [&](Part& part) {
    Device& own = part.particles.device();
    ParticleBatch batch;
    batch.assign(own, cloud.positions, Vec3f{});
    std::vector<int> every7th;
    for (int i = 0; i < std::ssize(cloud.positions); i += 7) every7th.push_back(i);
    const int kept = static_cast<int>(every7th.size());
    every7th.resize(cloud.positions.size());  // what is behind means nothing
    const Array<int> order(own, every7th), count(own, std::vector<int>{kept});
    const std::int64_t before = part.particles.refreshCount();
    part.divided.append(batch, {order.view(), count.data()});
    EXPECT_EQ(part.particles.nextId(), 2 * std::ssize(cloud.positions));
    const Ids ids = part.particles.ids().toHost(part.particles.bound());
    const std::vector<Vec3f> positions = part.particles.positions().toHost(part.particles.bound());
    part.divided.migrate();  // nobody has anything of another's
    EXPECT_EQ(part.particles.refreshCount(), std::ssize(ids));
    const std::lock_guard lock(mutex);
    for (auto i = static_cast<std::size_t>(before); i < ids.size(); ++i)
      EXPECT_TRUE(found.emplace(ids[i] - std::ssize(cloud.positions), positions[i]).second);
  });
  EXPECT_EQ(found.size(), (cloud.positions.size() + 6) / 7);
  for (const auto& [index, position] : found) {
    ASSERT_EQ(index % 7, 0);
    ASSERT_EQ(position, cloud.positions[std::size_t(index)]);
  }
}

/// In several parts, so that little is there twice.
TEST_P(DividedParticlesTest, MostGoToAnotherRankWhereAnotherAxisIsTheLongest) {
  const Cloud cloud = cloudAlong(0, 100'000);
  Aabb upright = cloud.box;
  upright.hi.y = upright.lo.y + 2 * upright.size().x;
  for (const int ranks : {2, 5}) {
    std::map<std::int64_t, int> owners;
    std::int64_t stayed = 0;
    std::mutex mutex;
    onRanks(ranks, cloud, [&](Part& part) {
      const int rank = part.divided.ranks().rank();
      const Ids before = part.particles.ids().toHost(part.particles.refreshCount());
      std::vector<float> values;
      for (const std::int64_t id : before) values.push_back(2 * float(id));
      part.field.assign(values);
      part.divided.cut(upright);
      const double held = double(part.particles.device().memoryUse().inUse);
      part.divided.migrate();
      // Of each 36 bytes are sent.
      EXPECT_LT(double(part.particles.device().memoryUse().inUse) - held,
                0.7 * 36 * double(cloud.positions.size()) / ranks);
      const Ids ids = part.particles.ids().toHost(part.particles.refreshCount());
      const std::vector<Vec3f> positions = part.particles.positions().toHost(std::ssize(ids));
      const std::vector<float> fields = part.field.toHost(std::ssize(ids));
      const std::lock_guard lock(mutex);
      for (std::size_t i = 0; i < ids.size(); ++i) {
        EXPECT_TRUE(owners.emplace(ids[i], rank).second) << ids[i] << " is there twice";
        ASSERT_EQ(part.divided.slabs().view().slabOf(positions[i]), rank);
        ASSERT_EQ(positions[i], cloud.positions[std::size_t(ids[i])]);
        ASSERT_EQ(fields[i], 2 * float(ids[i]));
      }
      for (const std::int64_t id : before) stayed += owners.contains(id) && owners[id] == rank ? 1 : 0;
    });
    EXPECT_EQ(owners.size(), cloud.positions.size());
    EXPECT_LT(stayed, 3 * std::ssize(cloud.positions) / 4);
  }
}

}  // namespace
}  // namespace weir::test
