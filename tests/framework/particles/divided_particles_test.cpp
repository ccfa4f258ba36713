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
      divided.cut(cloud.box, cloud.positions);
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

}  // namespace
}  // namespace weir::test
