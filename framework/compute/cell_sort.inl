// sortByCell, one source for both back ends. Included by cell_sort.h.
#pragma once

#include <limits>

#include "framework/base/api.h"

namespace WEIR_API weir {
namespace detail {

/// Sorts n ints in place in O(n log n) without recursion or memory, on any back end.
WEIR_HD inline void heapSort(int* a, int n) {
  const auto sink = [a](int root, int size) {
    const int value = a[root];
    for (int child = 2 * root + 1; child < size; child = 2 * root + 1) {
      if (child + 1 < size && a[child] < a[child + 1]) ++child;
      if (a[child] <= value) break;
      a[root] = a[child];
      root = child;
    }
    a[root] = value;
  };
  for (int root = n / 2 - 1; root >= 0; --root) sink(root, n);
  for (int last = n - 1; last > 0; --last) {
    const int largest = a[0];
    a[0] = a[last];
    a[last] = largest;
    sink(0, last);
  }
}

/// Counts the particles of every cell; who counts first gets the lower provisional rank. The dropped are
/// counted in a cell of their own behind the others.
template <class Key>
struct CountInCells {
  Key key;
  int cells;
  ArrayView<int> cell, rank, counts;

  WEIR_HD int cellOf(std::int64_t i) const {
    const int k = key(i);
    // A key outside the cells must not corrupt memory, so it drops the particle like -1.
    return k >= 0 && k < cells ? k : cells;
  }
  WEIR_HD void operator()(std::int64_t i) const {
    const int c = cellOf(i);
    cell[i] = c;
    rank[i] = atomicAdd(&counts[c], 1);
  }
};

struct ScatterToCells {
  ArrayView<const int> cell, rank, start;
  ArrayView<int> provisional;

  WEIR_HD void operator()(std::int64_t i) const {
    provisional[start[cell[i]] + rank[i]] = static_cast<int>(i);
  }
};

struct KeepOrder {
  WEIR_HD void operator()(std::int64_t, std::int64_t) const {}
};

/// Gives every particle its final place: in a small cell each one counts those that come before it, which
/// spreads the work evenly; a crowded cell is sorted as a whole by its first.
template <class Moved>
struct OrderInCells {
  static constexpr int kCrowded = 32;  // particles

  int cells;
  ArrayView<const int> cell, start, provisional;
  ArrayView<int> order;
  Moved moved;

  WEIR_HD void operator()(std::int64_t k) const {
    const int i = provisional[k];
    const int c = cell[i];
    if (c == cells) {
      order[k] = i;
      return;
    }
    const int begin = start[c];
    place(i, static_cast<int>(k) - begin, provisional.data + begin, begin, start[c + 1] - begin);
  }

  /// Of particle i, which is members[rank] of the `size` particles of a cell.
  WEIR_HD void place(int i, int rank, const int* members, int begin, int size) const {
    if (size <= kCrowded) {
      int before = 0;
      for (int m = 0; m < size; ++m) before += members[m] < i ? 1 : 0;
      put(begin + before, i);
    } else if (rank == 0) {
      for (int m = 0; m < size; ++m) order[begin + m] = members[m];
      sortCell(begin, size);
    }
  }

  WEIR_HD void put(int place, int i) const {
    order[place] = i;
    moved(place, i);
  }
  /// Of a crowded cell, whose members stand in `order`.
  WEIR_HD void sortCell(int begin, int size) const {
    heapSort(order.data + begin, size);
    for (int k = begin; k < begin + size; ++k) moved(k, order[k]);
  }
};

/// Sorts few particles in another way and returns true, where a back end has one.
template <class Key, class Moved>
bool sortFew(CudaDevice& device, Count count, const CountInCells<Key>& counting,
             const OrderInCells<Moved>& ordering, int* kept);
template <class Key, class Moved>
bool sortFew(CpuBackend&, Count, const CountInCells<Key>&, const OrderInCells<Moved>&, int*) {
  return false;
}

}  // namespace detail
}  // namespace weir

#ifdef __CUDACC__
#include "framework/compute/cell_sort_cuda.inl"
#endif

namespace WEIR_API weir {

template <class Backend, class Key, class Moved>
void sortByCell(Backend& device, Count count, int cells, const Key& key, int* kept,
                const CellSortMemory& memory, const Moved& moved) {
  WEIR_CHECK(cells >= 0);
  WEIR_CHECK(count.bound <= std::numeric_limits<int>::max());
  const auto& [start, cell, provisional, order] = memory;
  WEIR_CHECK(start.size == std::int64_t{cells} + 1);
  // Nobody asks for a rank once the order is made.
  const ArrayView<int> rank = order;

  const detail::CountInCells<Key> counting{key, cells, cell, rank, start};
  const detail::ScatterToCells scatter{cell, rank, start, provisional};
  const detail::OrderInCells<Moved> ordering{cells, cell, start, provisional, order, moved};
  if (detail::sortFew(device, count, counting, ordering, kept)) return;

  // The last entry counts the dropped before the scan, and is the number of the kept after it.
  device.fillBytes(start.data, 0, static_cast<std::size_t>(start.size) * sizeof(int));
  parallelFor(device, "countInCells", count, counting);
  exclusiveScan(device, start, start, start.size);
  parallelFor(device, "scatterToCells", count, scatter);
  parallelFor(device, "orderInCells", count, ordering);
  // Last, because `kept` may be where `count` stands.
  device.copy(kept, start.data + cells, sizeof(int));
}

template <class Backend, class Key>
void sortByCell(Backend& device, Count count, int cells, const Key& key, int* kept,
                const CellSortMemory& memory) {
  sortByCell(device, count, cells, key, kept, memory, detail::KeepOrder{});
}

}  // namespace weir
