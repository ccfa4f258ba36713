// Counting sort of particles by grid cell: the order in which neighbours are found and memory is read.
#pragma once

#include <array>

#include "framework/compute/parallel.h"

namespace weir {

/// Where each cell's particles stand after a sort. Cell c holds sorted places [start[c], start[c+1]).
class CellSort {
 public:
  explicit CellSort(Device& device)
      : start_(device), cell_(device), rank_(device), provisional_(device), order_(device) {}

  /// Room for so many particles and cells, so that sorts of no more allocate nothing. Loses the last order.
  void reserve(std::int64_t particles, std::int64_t cells) {
    for (Array<int>* array : perParticle()) array->reserveDiscarding(particles);
    start_.reserveDiscarding(cells + 1);
  }

  /// Arrays of integers, one for each particle and one for each cell.
  static constexpr int kPerParticle = 4;
  std::int64_t cellRoom() const { return start_.capacity(); }

  /// Sorts `count` particles into `cells` cells by key(i) in [0, cells). A key of -1 (or any
  /// other outside the cells) drops the particle: it is put behind all the others, and *kept (device memory)
  /// does not count it. *kept is start()[cells], and may stand where the exact count does. Within a cell,
  /// particles keep the order of their indices, so the result is unique on every back end and for every
  /// number of threads; dropped particles are in no particular order. Allocates only when a size grows, never
  /// waits.
  template <class Backend, class Key>
  void sort(Backend& device, Count count, int cells, const Key& key, int* kept);

  ArrayView<const int> start() const { return start_.view(); }  ///< size cells + 1
  ArrayView<const int> order() const {
    return order_.view();
  }  ///< order[k] = index before the sort of place k

 private:
  std::array<Array<int>*, kPerParticle> perParticle() { return {&cell_, &rank_, &provisional_, &order_}; }

  Array<int> start_, cell_, rank_, provisional_, order_;
};

}  // namespace weir

#include "framework/compute/cell_sort.inl"
