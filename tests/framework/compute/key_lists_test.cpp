// Lists by key against a map, and their sums.
#include "framework/compute/key_lists.h"
#include "framework/compute/dispatch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "tests/framework/compute/key_lists_kernel.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

using KeyListsTest = OnDevice;
WEIR_ON_EVERY_DEVICE(KeyListsTest);

struct Things {
  std::vector<int> keyOf;
  std::vector<float> values;
};

/// Half of them have the key 0, as of many solids one may have most particles; some have none.
Things randomThings(int count, int keys) {
  std::mt19937 random(unsigned(count + keys));
  std::uniform_int_distribution<int> pick(-1, keys - 1);
  std::uniform_real_distribution<float> number(-1, 1);
  Things things;
  for (int i = 0; i < count; ++i) {
    const int key = pick(random);
    things.keyOf.push_back(random() % 2 == 0 ? 0 : key);
    things.values.push_back(number(random) * std::exp(4 * number(random)));
  }
  return things;
}

struct Found {
  std::vector<int> first, item;
  std::vector<float> sums;
};

/// `extra` is what the host's bound of their number is above it.
Found listed(Device& device, KeyLists& lists, const Things& things, int keys, int extra = 0) {
  const auto count = static_cast<int>(things.keyOf.size());
  std::vector<int> padded = things.keyOf;
  padded.resize(padded.size() + std::size_t(extra), 0);
  const Array<int> keyOf(device, padded), exact(device, std::vector<int>{count});
  const Array<float> values(device, things.values);
  Array<float> sums(device, keys);
  dispatch(device, [&](auto& d) {
    listByKey(d, lists, Count(count + extra, exact.data()), keys, keyOf.view());
    sumListed(d, lists.view(), values.view(), keyOf.view(), sums.view());
  });
  const KeyListsView view = lists.view();
  Found found{std::vector<int>(std::size_t(view.first.size)), {}, sums.toHost()};
  device.download(found.first.data(), view.first.data, found.first.size() * sizeof(int));
  found.item.resize(std::size_t(found.first.back()));
  if (!found.item.empty())
    device.download(found.item.data(), view.item.data, found.item.size() * sizeof(int));
  return found;
}

Found listed(Device& device, const Things& things, int keys) {
  KeyLists lists(device);
  return listed(device, lists, things, keys);
}

TEST_P(KeyListsTest, HoldTheThingsOfEachKeyInTheirOrder) {
  KeyLists lists(*device);
  for (const int keys : {1, 16, 1000, 3000})
    for (const int count : {0, 1, 300, 4097, 100003}) {
      const Things things = randomThings(count, keys);
      std::map<int, std::vector<int>> expected;
      for (int i = 0; i < count; ++i)
        if (things.keyOf[std::size_t(i)] >= 0) expected[things.keyOf[std::size_t(i)]].push_back(i);
      const Found found = listed(*device, lists, things, keys, /*extra=*/1000);
      ASSERT_EQ(found.first.size(), std::size_t(keys + 1));
      for (int k = 0; k < keys; ++k) {
        const std::vector<int> ofKey(found.item.begin() + found.first[std::size_t(k)],
                                     found.item.begin() + found.first[std::size_t(k + 1)]);
        ASSERT_EQ(ofKey, expected[k]) << "key " << k << " of " << keys << ", " << count << " things";
      }
    }
}

TEST_P(KeyListsTest, SumsAreThoseOfEachKey) {
  for (const int keys : {1, 16, 700, 3000}) {
    const Things things = randomThings(100003, keys);
    std::vector<double> expected(std::size_t(keys), 0.0), sizes = expected;
    for (std::size_t i = 0; i < things.values.size(); ++i)
      if (const int k = things.keyOf[i]; k >= 0) {
        expected[std::size_t(k)] += double(things.values[i]);
        sizes[std::size_t(k)] += std::abs(double(things.values[i]));
      }
    const std::vector<float> sums = listed(*device, things, keys).sums;
    for (std::size_t k = 0; k < sums.size(); ++k)
      EXPECT_NEAR(sums[k], expected[k], 1e-5 * sizes[k]) << k << " of " << keys;
  }
}

/// So what a body feels does not change by what happens elsewhere.
TEST_P(KeyListsTest, SumsHaveTheSameBitsWhateverOtherKeysHave) {
  constexpr int kKeys = 40;
  const Things all = randomThings(50021, kKeys);
  const std::vector<float> sums = listed(*device, all, kKeys).sums;
  for (const int key : {0, 7, kKeys - 1}) {
    Things alone;
    for (std::size_t i = 0; i < all.keyOf.size(); ++i)
      if (all.keyOf[i] == key) {
        alone.keyOf.push_back(key);
        alone.values.push_back(all.values[i]);
      }
    EXPECT_EQ(listed(*device, alone, kKeys).sums[std::size_t(key)], sums[std::size_t(key)]) << key;
  }
}

TEST(KeyLists, SumsHaveTheSameBitsForAnyNumberOfThreads) {
  for (const int keys : {16, 1000}) {
    const Things things = randomThings(100003, keys);
    const auto one = openDevice("cpu", 1), four = openDevice("cpu", 4);
    EXPECT_EQ(listed(*one, things, keys).sums, listed(*four, things, keys).sums) << keys;
  }
}

TEST(KeyLists, AreOnlyOfManyKeysAndSayWhatTheyTake) {
  EXPECT_EQ(KeyLists::memoryFor(1e6, 2), 0);
  EXPECT_GE(KeyLists::memoryFor(1e6, 100), 1e6 * 16);
}

}  // namespace
}  // namespace weir::test
