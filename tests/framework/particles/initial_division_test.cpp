// Particles that ranks have made together stand where they belong, with the ids of one rank, and in no more
// room than there are.
#include "framework/particles/initial_division.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <numeric>
#include <random>
#include <tuple>
#include <vector>

#include "framework/communication/thread_ranks.h"
#include "framework/particles/make_room.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr float kCell = 0.05f;
constexpr std::int64_t kChunk = 97;  // that are made by turns

/// By id: what it is, and which rank has it.
struct Owned {
  std::int64_t id = 0;
  int rank = 0;
  Vec3f position, velocity;
};

std::vector<Vec3f> cloud(int count, unsigned seed, int longest) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Vec3f> points(static_cast<std::size_t>(count));
  for (Vec3f& p : points) {
    p = {unit(random), unit(random), unit(random)};
    p[longest] *= 2;
  }
  std::ranges::sort(points, {}, [](const Vec3f& p) { return std::tuple(p.z, p.y, p.x); });  // as samplers do
  return points;
}

/// A batch of these points, of which a rank makes some chunks.
struct Made {
  Made(Device& device, const std::vector<Vec3f>& points, const Vec3f& velocity, const Communicator& ranks) {
    std::vector<Vec3f> own;
    part.all = std::ssize(points);
    for (std::int64_t i = ranks.rank() * kChunk; i < part.all; i += ranks.size() * kChunk) {
      const auto begin = points.begin() + i, end = points.begin() + std::min(i + kChunk, part.all);
      part.runs.push_back({std::ssize(own), i, end - begin});
      own.insert(own.end(), begin, end);
    }
    batch.assign(device, own, velocity);
  }
  ParticleBatch batch;
  BatchPart part;
};

class InitialDivisionTest : public OnDevice {
 protected:
  std::vector<Owned> divide(int ranks, const std::vector<Vec3f>& first, const std::vector<Vec3f>& second) {
    std::vector<Owned> all;
    std::mutex mutex;
    std::vector<std::unique_ptr<Device>> devices(static_cast<std::size_t>(ranks));
    runOnThreads(ranks, [&](Communicator& communicator) {
      auto& here = devices[static_cast<std::size_t>(communicator.rank())] = openDevice(GetParam());
      ParticleSet particles(*here);
      DividedParticles divided(communicator, particles, kCell);
      Made one(*here, first, {1, 2, 3}, communicator), other(*here, second, {-1, 0, 4}, communicator);
      Aabb box;
      for (const auto* points : {&first, &second})
        for (const Vec3f& p : *points) box.extend(p);
      const InitialDivision division =
          initialDivision(communicator, box, {{&one.batch, &one.part}, {&other.batch, &other.part}}, kCell);
      divided.follow(division.slabs);
      makeRoom(particles, division.own);
      appendPart(divided, particles, one.batch, one.part);
      appendPart(divided, particles, other.batch, other.part);
      EXPECT_EQ(particles.bound(), division.own);
      EXPECT_LE(particles.capacity(), std::max<std::int64_t>(division.own, 4096));
      EXPECT_EQ(particles.nextId(), std::ssize(first) + std::ssize(second));
      const auto ids = particles.ids().toHost(particles.bound());
      const auto positions = particles.positions().toHost(particles.bound()),
                 velocities = particles.velocities().toHost(particles.bound());
      std::unique_lock lock(mutex);
      for (std::size_t i = 0; i < ids.size(); ++i) {
        EXPECT_EQ(division.slabs.view().slabOf(positions[i]), communicator.rank());
        all.push_back({ids[i], communicator.rank(), positions[i], velocities[i]});
      }
      lock.unlock();
      communicator.sum(0);
    });
    std::ranges::sort(all, {}, &Owned::id);
    return all;
  }
};

WEIR_ON_EVERY_DEVICE(InitialDivisionTest);

TEST_P(InitialDivisionTest, EachRankHasWhatIsInItsSlabWithTheIdsOfOne) {
  for (const int longest : {0, 2}) {
    const std::vector<Vec3f> first = cloud(30'000, 1, longest), second = cloud(2'000, 2, longest);
    for (const int ranks : {1, 2, 3, 7}) {
      const std::vector<Owned> all = divide(ranks, first, second);
      ASSERT_EQ(all.size(), first.size() + second.size());
      std::vector<std::int64_t> onRank(static_cast<std::size_t>(ranks));
      for (std::size_t i = 0; i < all.size(); ++i) {
        const bool isFirst = i < first.size();
        ASSERT_EQ(all[i].id, static_cast<std::int64_t>(i));
        ASSERT_EQ(all[i].position, isFirst ? first[i] : second[i - first.size()]);
        ASSERT_EQ(all[i].velocity, isFirst ? (Vec3f{1, 2, 3}) : (Vec3f{-1, 0, 4}));
        ++onRank[static_cast<std::size_t>(all[i].rank)];
      }
      // A layer of 41 and a bit is where a slab may end.
      EXPECT_LT(std::ranges::max(onRank), std::ssize(all) / ranks + std::ssize(all) / 30) << ranks;
    }
  }
}

TEST_P(InitialDivisionTest, SpaceIsCutAsForWhatEveryRankHas) {
  const std::vector<Vec3f> points = cloud(20'000, 3, 1);
  Aabb box;
  for (const Vec3f& p : points) box.extend(p);
  runOnThreads(3, [&](Communicator& ranks) {
    const auto here = openDevice(GetParam());
    ParticleSet particles(*here);
    DividedParticles divided(ranks, particles, kCell);
    ParticleBatch whole;
    whole.assign(*here, points, Vec3f{});
    divided.cut(box, {std::as_const(whole.positions).view()});
    Made made(*here, points, {}, ranks);
    const InitialDivision parts = initialDivision(ranks, box, {{&made.batch, &made.part}}, kCell),
                          wholes = initialDivision(ranks, box, {{&whole, nullptr}}, kCell);
    EXPECT_EQ(parts.slabs.cuts, divided.slabs().cuts);
    EXPECT_EQ(wholes.slabs.cuts, divided.slabs().cuts);
    EXPECT_EQ(parts.own, wholes.own);
    ranks.sum(0);
  });
}

}  // namespace
}  // namespace weir::test
