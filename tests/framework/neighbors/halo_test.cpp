// The particles of one cloud in several sets, each with a part of space and copies of what is near it: sums
// over neighbours are those of a single set to the last bit, and particles move from set to set with all that
// they have.
#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <vector>

#include "framework/compute/dispatch.h"
#include "framework/particles/pack_layout.h"
#include "tests/framework/neighbors/halo_sum_kernel.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr float kRadius = 0.06f;
constexpr int kCapacity = 128;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Aabb kEverywhere{{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};

/// Follows from the id, so that it can be looked at wherever the particle is.
Vec3f vectorOf(std::int64_t id, float attribute) {
  return {float(id), attribute, float(id % 1000) + 0.25f};
}
Mat3f matrixOf(std::int64_t id) {
  return {{vectorOf(id, 4), vectorOf(id, 5), vectorOf(id, 6)}};
}

/// Whether lists are made as fast as may be or as every back end can.
enum class Way { kFastest, kPortable };

/// A set with attributes of every type, and its lists.
struct Part {
  Part(Device& device, Way way) : particles(device), list(device), sums(device) {
    heat = particles.add<float>({.name = "heat", .unit = "", .doc = ""});
    spin = particles.add<Vec3f>({.name = "spin", .unit = "", .doc = ""});
    field = particles.add<Vec3f>({.name = "field", .unit = "", .doc = ""});
    stress = particles.add<Mat3f>({.name = "stress", .unit = "", .doc = ""});
    phase = particles.add<int>({.name = "phase", .unit = "", .doc = ""});
    stamp = particles.add<std::int64_t>({.name = "stamp", .unit = "", .doc = ""});
    particles.add<float>({.name = "derived", .unit = "", .doc = "", .derived = true});
    list.configure(kRadius, kCapacity);
    list.orderByIds();
    if (way == Way::kPortable) list.usePortableSearch();
  }

  std::vector<std::int64_t> ids() { return particles.ids().toHost(particles.refreshCount()); }

  /// Indices of the owned particles with low ≤ x < high, on the device.
  Array<int> within(float low, float high) {
    const std::vector<Vec3f> p = particles.positions().toHost(particles.refreshCount());
    std::vector<int> found;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p[i].x >= low && p[i].x < high) found.push_back(int(i));
    return {particles.device(), found};
  }

  void sum() {
    sums.resizeDiscarding(particles.capacity());
    dispatch(particles.device(), [&](auto& device) {
      sumFields(device, particles.count(), list.view(), kRadius, particles.positions().read(), field.read(),
                sums.view());
    });
  }

  ParticleSet particles;
  NeighborList list;
  Array<Vec4f> sums;
  Attribute<float> heat;
  Attribute<Vec3f> spin, field;
  Attribute<Mat3f> stress;
  Attribute<int> phase;
  Attribute<std::int64_t> stamp;
};

/// What is known of a particle after a step.
struct Known {
  Vec3f position, velocity;
  Vec4f sums;
  float crowding = 0;
  friend bool operator==(const Known&, const Known&) = default;
};

class HaloTest : public OnDevice {
 protected:
  static constexpr int kCount = 12000;

  /// So few are searched for by teams on CUDA, whose lists have another order.
  Way wayOfFew() const { return device->kind() == DeviceKind::kCuda ? Way::kPortable : Way::kFastest; }

  /// Of kCount for each m along x.
  std::unique_ptr<Part> wholeCloud(Way way, int count = kCount) const {
    auto part = std::make_unique<Part>(*device, way);
    const float length = float(count) / kCount;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1), speed(-1, 1);
    std::vector<Vec3f> positions, velocities, spins;
    std::vector<float> heats;
    std::vector<Mat3f> stresses;
    std::vector<int> phases;
    std::vector<std::int64_t> stamps;
    for (std::int64_t i = 0; i < count; ++i) {
      positions.push_back({length * unit(random), 0.6f * unit(random), 0.5f * unit(random)});
      velocities.push_back({2 + speed(random), speed(random), speed(random)});
      heats.push_back(0.5f + float(i));
      spins.push_back(vectorOf(i, 3));
      stresses.push_back(matrixOf(i));
      phases.push_back(int(3 * i));
      stamps.push_back((std::int64_t{1} << 40) * (i % 5) + i);
    }
    ParticleBatch batch;
    batch.assign(*device, positions, velocities);
    part->particles.append(batch);
    part->heat.assign(heats);
    part->spin.assign(spins);
    part->field.assign(spins);
    part->stress.assign(stresses);
    part->phase.assign(phases);
    part->stamp.assign(stamps);
    return part;
  }

  /// Several sets; number k has what is between cuts[k] and cuts[k + 1].
  struct Parts {
    std::vector<float> cuts;
    std::vector<std::unique_ptr<Part>> all;
    std::vector<std::vector<HaloRange>> ranges;  // of what k has of m
    std::vector<std::vector<Array<int>>> shown;  // what k has shown to m

    Part& operator[](std::size_t k) { return *all[k]; }
    std::size_t size() const { return all.size(); }
  };

  Parts divide(Part& whole, Way way, const std::vector<float>& inner) const {
    Parts parts;
    parts.cuts = {-kInfinity};
    parts.cuts.insert(parts.cuts.end(), inner.begin(), inner.end());
    parts.cuts.push_back(kInfinity);
    const PackLayout layout(whole.particles);
    Array<std::byte> buffer(*device);
    for (std::size_t k = 0; k + 1 < parts.cuts.size(); ++k) {
      auto& part = parts.all.emplace_back(std::make_unique<Part>(*device, way));
      const Array<int> indices = whole.within(parts.cuts[k], parts.cuts[k + 1]);
      whole.particles.pack(layout, indices.view(), buffer);
      PackLayout(part->particles).checkSame(layout.describe(), "the whole");
      part->particles.appendPacked(layout, std::as_const(buffer).view());
    }
    return parts;
  }

  /// Particles go to the set that has the place where they are now.
  void migrate(Parts& parts, int& moved) const {
    const PackLayout layout(parts[0].particles);
    std::vector<std::vector<Array<std::byte>>> messages(parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
      ParticleSet& from = parts[k].particles;
      for (std::size_t m = 0; m < parts.size(); ++m) {
        Array<std::byte>& message = messages[k].emplace_back(*device);
        if (m == k) continue;
        const Array<int> leaving = parts[k].within(parts.cuts[m], parts.cuts[m + 1]);
        from.pack(layout, leaving.view(), message);
        from.remove(leaving.toHost());
        moved += int(leaving.size());
      }
    }
    for (std::size_t m = 0; m < parts.size(); ++m)
      for (std::size_t k = 0; k < parts.size(); ++k)
        if (m != k) parts[m].particles.appendPacked(layout, std::as_const(messages[k][m]).view());
  }

  /// Of what is no farther than the radius.
  void exchangeHalos(Parts& parts) const {
    const PackLayout layout(parts[0].particles);
    Array<std::byte> message(*device);
    parts.ranges.assign(parts.size(), std::vector<HaloRange>(parts.size()));
    parts.shown.clear();
    for (std::size_t k = 0; k < parts.size(); ++k) {
      std::vector<Array<int>>& shown = parts.shown.emplace_back();
      for (std::size_t m = 0; m < parts.size(); ++m)
        shown.push_back(parts[k].within(parts.cuts[m] - kRadius, parts.cuts[m + 1] + kRadius));
    }
    for (std::size_t k = 0; k < parts.size(); ++k)
      for (std::size_t m = 0; m < parts.size(); ++m) {
        if (m == k) continue;
        parts[k].particles.pack(layout, parts.shown[k][m].view(), message);
        parts.ranges[m][k] = parts[m].particles.appendHalo(layout, std::as_const(message).view());
      }
  }

  void refreshFields(Parts& parts) const {
    const PackLayout layout(parts[0].particles, {"field"});
    Array<std::byte> message(*device);
    for (std::size_t k = 0; k < parts.size(); ++k)
      for (std::size_t m = 0; m < parts.size(); ++m) {
        if (m == k) continue;
        parts[k].particles.pack(layout, parts.shown[k][m].view(), message);
        parts[m].particles.refreshHalo(layout, std::as_const(message).view(), parts.ranges[m][k]);
      }
  }

  static void find(Part& part) {
    const Aabb box{{-0.5f, 0, 0}, {2, 0.6f, 0.5f}};
    part.list.fitGrid(box, part.particles.bound());
    part.list.sort(part.particles, kEverywhere);
  }

  /// The sums become the field of the next ones.
  static void keepSums(Part& part) {
    const std::int64_t n = part.particles.refreshCount();
    std::vector<Vec3f> fields;
    for (const Vec4f& s : part.sums.toHost(n)) fields.push_back({s.x, s.y, s.w});
    part.field.assign(fields);
  }

  /// By id. Fails where a particle is there twice, or lacks something that it had.
  static void learn(Part& part, std::map<std::int64_t, Known>& known) {
    const std::int64_t n = part.particles.refreshCount();
    const std::vector<std::int64_t> ids = part.ids(), stamps = part.stamp.toHost(n);
    const std::vector<Vec3f> positions = part.particles.positions().toHost(n),
                             velocities = part.particles.velocities().toHost(n), spins = part.spin.toHost(n);
    const std::vector<Mat3f> stresses = part.stress.toHost(n);
    const std::vector<float> heats = part.heat.toHost(n);
    const std::vector<int> phases = part.phase.toHost(n);
    const std::vector<Vec4f> sums = part.sums.toHost(n);
    std::vector<float> crowding(ids.size());
    const ArrayView<const float> found = part.particles.byProducts().find(kCrowding);
    ASSERT_GE(found.size, n);
    part.particles.device().download(crowding.data(), found.data, crowding.size() * sizeof(float));
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const std::int64_t id = ids[i];
      ASSERT_TRUE(known.emplace(id, Known{positions[i], velocities[i], sums[i], crowding[i]}).second) << id;
      ASSERT_EQ(heats[i], 0.5f + float(id));
      ASSERT_EQ(spins[i], vectorOf(id, 3));
      ASSERT_EQ(stresses[i], matrixOf(id));
      ASSERT_EQ(phases[i], int(3 * id));
      ASSERT_EQ(stamps[i], (std::int64_t{1} << 40) * (id % 5) + id);
    }
  }
};
WEIR_ON_EVERY_DEVICE(HaloTest);

TEST_P(HaloTest, SumsAndFlightAreThoseOfASingleSetToTheLastBit) {
  // The cuts go through cells; the third division has parts thinner than the radius.
  for (const std::vector<float>& cuts : {std::vector<float>{0.97f}, std::vector<float>{0.4f, 0.9f},
                                         std::vector<float>{0.8f, 0.83f, 0.86f, 1.1f}}) {
    const auto whole = wholeCloud(wayOfFew());
    Parts parts = divide(*whole, wayOfFew(), cuts);
    int moved = 0;
    for (int step = 0; step < 10; ++step) {
      SCOPED_TRACE(std::to_string(parts.size()) + " parts, step " + std::to_string(step));
      // Over the cuts and back.
      const FreeMotion motion{{step < 5 ? 30.0f : -90.0f, -9.8f, 1}, 0.02f};
      whole->particles.move(motion);
      for (const auto& part : parts.all) part->particles.move(motion);
      migrate(parts, moved);
      find(*whole);
      for (const auto& part : parts.all) find(*part);
      exchangeHalos(parts);
      std::map<std::int64_t, Known> expected, known;
      for (int times = 0; times < 2; ++times) {
        if (times == 0) whole->list.list(whole->particles);
        whole->sum();
        for (const auto& part : parts.all) {
          if (times == 0) part->list.list(part->particles);
          part->sum();
        }
        if (times == 1) break;
        keepSums(*whole);
        for (const auto& part : parts.all) keepSums(*part);
        refreshFields(parts);
      }
      learn(*whole, expected);
      for (const auto& part : parts.all) {
        EXPECT_EQ(part->list.eventsOnHost().truncated, 0);
        EXPECT_EQ(part->list.eventsOnHost().cutOffByOrder, 0);
        learn(*part, known);
      }
      ASSERT_EQ(known.size(), std::size_t(kCount));
      ASSERT_TRUE(known == expected);
    }
    EXPECT_GT(moved, 2000);
  }
}

TEST_P(HaloTest, ListsAreInTheOrderOfCellsAndIds) {
  const auto whole = wholeCloud(wayOfFew());
  Parts parts = divide(*whole, wayOfFew(), {0.5f});
  for (const auto& part : parts.all) find(*part);
  exchangeHalos(parts);
  whole->list.build(whole->particles, kEverywhere);
  std::map<std::int64_t, std::vector<std::int64_t>> expected;
  const std::vector<std::int64_t> all = whole->ids();
  const auto lists = whole->list.listsOnHost(kCount);
  for (std::size_t i = 0; i < lists.size(); ++i)
    for (const int j : lists[i]) expected[all[i]].push_back(all[std::size_t(j)]);
  for (const auto& part : parts.all) {
    part->list.list(part->particles);
    const std::int64_t n = part->particles.refreshCount(), halo = part->particles.haloCount();
    EXPECT_GT(halo, 100);
    const std::vector<std::int64_t> ids = part->particles.ids().toHost(n + halo);
    const auto found = part->list.listsOnHost(n);
    bool reachesHalo = false;
    for (std::size_t i = 0; i < found.size(); ++i) {
      std::vector<std::int64_t> named;
      for (const int j : found[i]) named.push_back(ids[std::size_t(j)]), reachesHalo |= j >= n;
      ASSERT_EQ(named, expected[ids[i]]);
    }
    EXPECT_TRUE(reachesHalo);
  }
}

/// Of more particles than teams search for. Some lists are of a set's own particles alone.
TEST_P(HaloTest, EachSearchFindsThemAsInASingleSet) {
  constexpr int kMany = 90000;
  std::map<std::int64_t, Known> ofWay[2];
  for (const Way way : {Way::kFastest, Way::kPortable}) {
    const auto whole = wholeCloud(way, kMany);
    Parts parts = divide(*whole, way, {3.71f});
    for (const auto& part : parts.all) find(*part);
    exchangeHalos(parts);
    find(*whole);
    whole->list.list(whole->particles);
    whole->sum();
    std::map<std::int64_t, Known> known, &expected = ofWay[int(way)];
    learn(*whole, expected);
    for (const auto& part : parts.all) {
      part->list.list(part->particles);
      part->sum();
      EXPECT_EQ(part->list.eventsOnHost().cutOffByOrder, 0);
      learn(*part, known);
    }
    ASSERT_TRUE(known == expected) << int(way);
  }
  for (const auto& [id, known] : ofWay[0]) {
    ASSERT_EQ(known.sums, ofWay[1].at(id).sums) << "another order";
    ASSERT_NEAR(known.crowding, ofWay[1].at(id).crowding, 1e-4);
  }
}

/// More of the halo than a list has room for, and more in a row than the fastest search takes at once.
TEST_P(HaloTest, AreCutOffWhereTheyAreTooMany) {
  for (const Way way : {Way::kFastest, Way::kPortable}) {
    Part part(*device, way), other(*device, way);
    ParticleBatch one, many;
    one.assign(*device, std::vector<Vec3f>{{0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.51f}}, Vec3f{});
    many.assign(*device, std::vector<Vec3f>(3000, Vec3f{0.51f, 0.5f, 0.5f}), Vec3f{});
    part.particles.append(one);
    other.particles.continueIdsFrom(2);
    other.particles.append(many);
    const PackLayout layout(part.particles);
    const Array<int> all = other.within(-1, 1);
    Array<std::byte> message(*device);
    other.particles.pack(layout, all.view(), message);
    find(part);
    part.particles.appendHalo(layout, std::as_const(message).view());
    part.list.list(part.particles);
    EXPECT_EQ(part.list.eventsOnHost().truncated, 2);
    EXPECT_EQ(part.list.countsOnHost(2), (std::vector<int>{kCapacity, kCapacity}));
    const std::vector<std::vector<int>> lists = part.list.listsOnHost(2);
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < kCapacity; ++k)
        ASSERT_EQ(lists[std::size_t(i)][std::size_t(k)], k == 0 ? 1 - i : 1 + k) << i << ", " << k;
  }
}

}  // namespace
}  // namespace weir::test
