#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "framework/compute/dispatch.h"
#include "tests/framework/neighbors/neighbor_sum_kernel.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr int kParticles = 41;
constexpr int kRoom = 48;

/// Particle i has i neighbours.
std::vector<int> eachOneMore() {
  std::vector<int> counts;
  for (int i = 0; i < kParticles; ++i) counts.push_back(i);
  return counts;
}

/// Of eight particles side by side all have as many, none has any, only the last one has some, all but one
/// have as many as there can be, and only the first one has none.
std::vector<int> unevenEights() {
  std::vector<int> counts;
  for (int i = 0; i < kParticles; ++i) {
    const bool first = i % kEight == 0, last = i % kEight == kEight - 1;
    const int of[] = {7, 0, last ? 33 : 0, last ? 1 : 40, first ? 0 : 9, 5};
    counts.push_back(of[i / kEight]);
  }
  return counts;
}

/// Neighbours of particles, some of them in their own place; all other entries are a particle's own index.
struct Lists {
  std::vector<Vec4f> weighted;
  std::vector<Vec3f> positions;
  std::vector<int> entries = std::vector<int>(kParticles * kRoom), counts;

  explicit Lists(const std::vector<int>& lengths) : counts(lengths) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> number(-1, 1);
    for (int i = 0; i < kParticles; ++i) {
      // Twos share a place.
      const Vec3f p = i % 2 == 1 ? positions.back() : Vec3f{number(random), number(random), number(random)};
      positions.push_back(p);
      weighted.push_back({p.x, p.y, p.z, number(random)});
      const int count = counts[static_cast<std::size_t>(i)];
      for (int k = 0; k < kRoom; ++k)
        entries[static_cast<std::size_t>(i * kRoom + k)] = k < count ? (i + 1 + k) % kParticles : i;
    }
  }

  std::vector<Vec4f> sums(Device& device) const {
    const Array<Vec4f> w(device, weighted);
    const Array<Vec3f> p(device, positions);
    const Array<int> c(device, counts);
    Array<Vec4f> out(device, kParticles);
    const bool packs = device.kind() == DeviceKind::kCuda;
    const Array<int> e(device, packs ? codes() : interleaved());
    Array<ListGroup> groups(device, packs ? 2 : 0);
    groups.fillZero();  // codes are indices
    NeighborView list{e.data(), c.data(), kRoom, {}};
    if (packs)
      list.packed = {reinterpret_cast<FourCodes*>(const_cast<int*>(e.data())), groups.data(), nullptr, 0,
                     kRoom};
    dispatch(device, [&](auto& d) { sumPairs(d, list, w.view(), p.view(), out.view()); });
    return out.toHost();
  }

  /// The lists as CUDA packs them, with a code for what stands behind their ends, too.
  std::vector<int> codes() const {
    std::vector<int> packed(2 * kListGroup * kRoom / kCodesInInt);
    const PackedLists to{reinterpret_cast<FourCodes*>(packed.data()), nullptr, nullptr, 0, kRoom};
    for (int i = 0; i < kParticles; ++i)
      for (int k = 0; k < kRoom; ++k)
        *to.code(i, k) = static_cast<std::uint16_t>(entries[static_cast<std::size_t>(i * kRoom + k)]);
    return packed;
  }

  /// As the CPU keeps them.
  std::vector<int> interleaved() const {
    std::vector<int> places((kParticles + kInterleaved) * kRoom);
    for (int i = 0; i < kParticles; ++i)
      for (int k = 0; k < kRoom; ++k)
        places[static_cast<std::size_t>(listPlace(i, kRoom) + k * kInterleaved)] =
            entries[static_cast<std::size_t>(i * kRoom + k)];
    return places;
  }

  std::array<double, 4> expected(int i) const {
    std::array<double, 4> sum{};
    for (int k = 0; k < counts[static_cast<std::size_t>(i)]; ++k) {
      const auto a = static_cast<std::size_t>(i);
      const auto j = static_cast<std::size_t>((i + 1 + k) % kParticles);
      double d[3];
      for (int axis = 0; axis < 3; ++axis) d[axis] = double(positions[j][axis]) - double(positions[a][axis]);
      const double r = std::hypot(d[0], d[1], d[2]);
      if (r == 0) d[0] = j > a ? 1 : -1;
      for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += d[axis] * double(weighted[j].w);
      sum[3] += r;
    }
    return sum;
  }
};

TEST(NeighborSum, IsThatOfDoublePrecisionForListsOfAnyLength) {
  for (const Lists& lists : {Lists(eachOneMore()), Lists(unevenEights())}) {
    for (const std::string& name : availableDevices()) {
      const auto device = openDevice(name);
      const std::vector<Vec4f> sums = lists.sums(*device);
      for (int i = 0; i < kParticles; ++i) {
        const auto expected = lists.expected(i);
        const Vec4f& sum = sums[static_cast<std::size_t>(i)];
        const int count = lists.counts[static_cast<std::size_t>(i)];
        EXPECT_NEAR(sum.x, expected[0], 1e-5) << name << ", " << i << ", " << count << " neighbours";
        EXPECT_NEAR(sum.y, expected[1], 1e-5) << name << ", " << i << ", " << count << " neighbours";
        EXPECT_NEAR(sum.z, expected[2], 1e-5) << name << ", " << i << ", " << count << " neighbours";
        EXPECT_NEAR(sum.w, expected[3], 2e-5) << name << ", " << i << ", " << count << " neighbours";
      }
    }
  }
}

TEST(NeighborSum, IsBitwiseTheSameForAllInstructionsOfTheCpu) {
  for (const Lists& lists : {Lists(eachOneMore()), Lists(unevenEights())}) {
    CpuDevice baseline(1, CpuIsa::kBaseline);
    const std::vector<Vec4f> expected = lists.sums(baseline);
    for (const CpuIsa isa : usableCpuIsas()) {
      CpuDevice device(2, isa);
      EXPECT_EQ(lists.sums(device), expected) << cpuIsaName(isa);
    }
  }
}

}  // namespace
}  // namespace weir::test
