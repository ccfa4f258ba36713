// Lists and sums by key on a device.
#pragma once

#include "framework/compute/key_lists.h"

namespace weir::test {

/// Lists thing i by its key, and nowhere where that is below 0.
template <class Backend>
void listByKey(Backend& device, KeyLists& lists, const Count& things, std::int64_t keys,
               ArrayView<const int> keyOf);

/// sums[k] = Σ of the values that are in the list of k.
template <class Backend>
void sumListed(Backend& device, const KeyListsView& lists, ArrayView<const float> values,
               ArrayView<const int> keyOf, ArrayView<float> sums);

}  // namespace weir::test
