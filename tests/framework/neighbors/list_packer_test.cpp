// Packed lists: what is put in comes out, in windows, as indices in place and in blocks; what has no room is
// counted. The threads of a group are threads of the host here.
#include "framework/neighbors/list_packer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <barrier>
#include <thread>

#include "framework/neighbors/neighbor_list.h"

namespace weir {
namespace {

using Lists = std::vector<std::vector<int>>;

/// A list in ascending order of layers, and where these begin.
struct Found {
  std::vector<int> index;
  int own = 0, above = 0;
};

/// What the threads of a group tell one another.
class Meeting {
 public:
  explicit Meeting(int threads) : told_(static_cast<std::size_t>(threads)), barrier_(threads) {}
  std::vector<int> ask(int thread, int value) {
    told_[static_cast<std::size_t>(thread)] = value;
    barrier_.arrive_and_wait();
    std::vector<int> all = told_;
    barrier_.arrive_and_wait();
    return all;
  }

 private:
  std::vector<int> told_;
  std::barrier<> barrier_;
};

struct HostThreads {
  Meeting* meeting;
  int thread;

  int min(int value) const { return std::ranges::min(meeting->ask(thread, value)); }
  bool all(bool value) const { return min(value ? 1 : 0) == 1; }
  int ofFirst(int value) const { return meeting->ask(thread, value)[0]; }
};

class Packed {
 public:
  Packed(int capacity, int blocks, std::size_t particles)
      : particles_(particles),
        groups_((particles + kListGroup - 1) / kListGroup),
        codes_(groups_.size() * kListGroup * static_cast<std::size_t>(capacity) / kCodesTogether),
        blocks_(static_cast<std::size_t>(blocks * capacity * kListGroup)),
        counts_(particles),
        packer_{{codes_.data(), groups_.data(), blocks_.data(), blocks, capacity}, &wanted_, &short_, false} {
  }

  void pack(const std::vector<Found>& lists) {
    for (std::size_t first = 0; first < particles_; first += kListGroup) {
      const int threads = static_cast<int>(std::min<std::size_t>(kListGroup, particles_ - first));
      Meeting meeting(threads);
      std::vector<std::jthread> group;
      for (int t = 0; t < threads; ++t)
        group.emplace_back([&, t] {
          const std::size_t i = first + static_cast<std::size_t>(t);
          std::vector<int> memory = lists[i].index;
          counts_[i] = packer_.pack(static_cast<std::int64_t>(i),
                                    {.index = {memory.data(), 1},
                                     .kept = static_cast<int>(memory.size()),
                                     .own = lists[i].own,
                                     .above = lists[i].above},
                                    HostThreads{&meeting, t});
        });
    }
  }

  NeighborView view() { return {nullptr, counts_.data(), packer_.lists.capacity, packer_.lists}; }
  std::vector<int> list(std::size_t i) {
    std::vector<int> read;
    forEachNeighbor(static_cast<std::int64_t>(i), view(), [&](int j) { read.push_back(j); });
    return read;
  }
  NeighborEditor editor() { return {plain_.data(), counts_.data(), packer_.lists.capacity, packer_.lists}; }
  int wide(std::size_t group) const { return groups_[group].wide; }
  int wanted() const { return wanted_; }
  int inVain() const { return short_; }

 private:
  std::size_t particles_;
  std::vector<ListGroup> groups_;
  std::vector<FourCodes> codes_;
  std::vector<int> blocks_, counts_;
  std::vector<int> plain_ = {0};  // lists that are not packed, which nobody reads
  int wanted_ = 0, short_ = 0;
  ListPacker packer_;
};

/// Of particle i: that many neighbours in each layer, around the places where the layers begin.
Found listOf(int i, std::array<int, 3> counts, std::array<int, 3> layers, int apart) {
  Found found;
  for (std::size_t layer = 0; layer < 3; ++layer) {
    if (layer == 1) found.own = static_cast<int>(found.index.size());
    if (layer == 2) found.above = static_cast<int>(found.index.size());
    for (int k = 0; k < counts[layer]; ++k) found.index.push_back(layers[layer] + i + k * apart);
  }
  return found;
}

TEST(ListPacker, KeepsListsInThreeWindowsAnywhere) {
  std::vector<Found> lists;
  for (int i = 0; i < 70; ++i)
    lists.push_back(listOf(i, {i % 4, (i * 7) % 5, (i / 3) % 4}, {2'000'000'000, 5, 80'000}, 7000));
  Packed packed(12, 0, lists.size());
  packed.pack(lists);
  for (std::size_t i = 0; i < lists.size(); ++i) EXPECT_EQ(packed.list(i), lists[i].index) << i;
  for (std::size_t group = 0; group < 3; ++group) EXPECT_EQ(packed.wide(group), 0);
}

TEST(ListPacker, TheLastIndexOfAWindowFits) {
  for (const int beyond : {0, 1}) {
    Packed packed(8, 0, 2);
    const std::vector<Found> lists{{{100}, 0, 1}, {{100 + kWindow - 1 + beyond}, 0, 1}};
    packed.pack(lists);
    EXPECT_EQ(packed.wide(0), beyond);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(packed.list(i), lists[i].index);
  }
}

TEST(ListPacker, KeepsIndicesThatAreFarApart) {
  // Four groups: two have a list of more than half, for one of which there is a block.
  std::vector<Found> lists;
  for (int i = 0; i < 4 * kListGroup; ++i)
    lists.push_back(listOf(i, {0, i == 5 || i == 40 ? 7 : 3, 1}, {0, 0, 90'000}, 30'000));
  Packed packed(8, 1, lists.size());
  packed.pack(lists);
  EXPECT_EQ(packed.wanted(), 2);
  EXPECT_EQ(packed.inVain(), 1);
  EXPECT_EQ(packed.wide(0), 2);
  for (std::size_t group = 1; group < 4; ++group) EXPECT_EQ(packed.wide(group), 1);
  for (std::size_t i = 0; i < lists.size(); ++i) {
    std::vector<int> expected = lists[i].index;
    if (i == 40) expected.resize(4);  // what has no room is not there, and pack() says so
    EXPECT_EQ(packed.list(i), expected) << i;
  }
}

TEST(ListPacker, EntriesCanBeTakenOut) {
  for (const int apart : {10, 30'000}) {
    std::vector<Found> lists;
    for (int i = 0; i < 3; ++i) lists.push_back(listOf(i, {2, 3, 2}, {0, 100'000, 200'000}, apart));
    Packed packed(16, 1, lists.size());
    packed.pack(lists);
    const NeighborEditor editor = packed.editor();
    editor.keepIf(1, Team{}, [](int j) { return j % 4 != 1; });
    std::vector<int> expected = lists[1].index;
    std::erase_if(expected, [](int j) { return j % 4 == 1; });
    EXPECT_LT(expected.size(), lists[1].index.size());
    EXPECT_EQ(packed.list(1), expected);
    EXPECT_EQ(packed.list(0), lists[0].index);
    EXPECT_EQ(packed.list(2), lists[2].index);
  }
}

}  // namespace
}  // namespace weir
