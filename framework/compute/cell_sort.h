// Counting sort of particles by grid cell: the order in which neighbours are found and memory is read.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/parallel.h"

namespace WEIR_API weir {

/// Memory that a sort works in. `order` is needed for ranks before it is made; `cell` and `provisional` mean
/// nothing afterwards.
struct CellSortMemory {
  ArrayView<int> start;                     ///< size cells + 1
  ArrayView<int> cell, provisional, order;  ///< one for each particle
};

/// Sorts `count` particles into `cells` cells by key(i) in [0, cells). A key of -1 (or any
/// other outside the cells) drops the particle: it is put behind all the others, and *kept (device memory)
/// does not count it. *kept is start[cells], and may stand where the exact count does. Cell c then holds
/// the sorted places [start[c], start[c+1]), and order[k] is the index that place k had before. Within a
/// cell, particles keep the order of their indices, so the result is unique on every back end and for every
/// number of threads; dropped particles are in no particular order. moved(k, order[k]) is called for each
/// that is kept, as soon as its place is known. Allocates little and never waits.
template <class Backend, class Key, class Moved>
void sortByCell(Backend& device, Count count, int cells, const Key& key, int* kept,
                const CellSortMemory& memory, const Moved& moved);
template <class Backend, class Key>
void sortByCell(Backend& device, Count count, int cells, const Key& key, int* kept,
                const CellSortMemory& memory);

/// A sort with memory of its own.
class CellSort {
 public:
  explicit CellSort(Device& device) : start_(device), cell_(device), provisional_(device), order_(device) {}

  /// As sortByCell(). Allocates only when a size grows.
  template <class Backend, class Key>
  void sort(Backend& device, Count count, int cells, const Key& key, int* kept) {
    start_.resizeDiscarding(std::int64_t{cells} + 1);
    for (Array<int>* array : {&cell_, &provisional_, &order_}) array->resizeDiscarding(count.bound);
    sortByCell(device, count, cells, key, kept,
               {start_.view(), cell_.view(), provisional_.view(), order_.view()});
  }

  /// Arrays of integers that it holds for each particle.
  static constexpr int kPerParticle = 3;

  ArrayView<const int> start() const { return start_.view(); }
  ArrayView<const int> order() const { return order_.view(); }
  ArrayView<int> orderToChange() { return order_.view(); }

 private:
  Array<int> start_, cell_, provisional_, order_;
};

}  // namespace weir

#include "framework/compute/cell_sort.inl"
