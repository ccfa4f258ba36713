#include "tests/framework/compute/key_lists_kernel.h"

namespace weir::test {
namespace {

struct WriteKeys {
  ArrayView<const int> keyOf;
  ArrayView<std::uint32_t> keys;
  ArrayView<int> items;

  WEIR_HD void operator()(std::int64_t i) const {
    if (keyOf[i] >= 0) keys[i] = static_cast<std::uint32_t>(keyOf[i]);
    items[i] = static_cast<int>(i);
  }
};

struct ValueByKey {
  ArrayView<const float> values;
  ArrayView<const int> keyOf;

  template <class Give>
  WEIR_HD void operator()(std::int64_t i, const Give& give) const {
    if (keyOf[i] >= 0) give(keyOf[i], [&] { return values[i]; });
  }
};

struct Add {
  WEIR_HD float operator()(float a, float b) const { return a + b; }
};

}  // namespace

template <class Backend>
void listByKey(Backend& device, KeyLists& lists, const Count& things, std::int64_t keys,
               ArrayView<const int> keyOf) {
  lists.clear(device, things);
  parallelFor(device, "writeKeys", things, WriteKeys{keyOf, lists.keys(), lists.items()});
  lists.sort(device, keys);
}

template <class Backend>
void sumListed(Backend& device, const KeyListsView& lists, ArrayView<const float> values,
               ArrayView<const int> keyOf, ArrayView<float> sums) {
  reduceListed(device, "sumListed", lists, 0.0f, ValueByKey{values, keyOf}, Add{}, sums.data);
}

template void listByKey(ThisBackend&, KeyLists&, const Count&, std::int64_t, ArrayView<const int>);
template void sumListed(ThisBackend&, const KeyListsView&, ArrayView<const float>, ArrayView<const int>,
                        ArrayView<float>);

}  // namespace weir::test
