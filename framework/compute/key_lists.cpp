#include "framework/compute/key_lists.h"

namespace weir {

void KeyLists::clear(std::int64_t entries) {
  if (entries > keys_.capacity()) {
    const std::int64_t room = grownSize(keys_.capacity(), entries);
    keys_.reserveDiscarding(room);
    items_.reserveDiscarding(room);
  }
  keys_.resizeDiscarding(entries);
  items_.resizeDiscarding(entries);
  // The largest key of all, which is behind all others.
  if (entries > 0)
    keys_.device().fillBytes(keys_.data(), 0xff, static_cast<std::size_t>(entries) * sizeof(std::uint32_t));
}

double KeyLists::memoryFor(double entries, std::int64_t keys) {
  if (areFew(keys)) return 0;
  // Sorting needs both twice.
  return entries * 2 * (sizeof(std::uint32_t) + sizeof(int)) + double(keys + 1) * sizeof(int);
}

}  // namespace weir
