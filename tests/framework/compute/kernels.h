// Kernels for the tests of the primitives, compiled for each back end in kernels.dual.cpp.
#pragma once

#include "framework/base/vec.h"
#include "framework/compute/cell_sort.h"
#include "framework/compute/exact_sum.h"
#include "framework/compute/parallel.h"

namespace weir::test {

/// out[i] = i*i + 1
template <class Backend>
void writeSquares(Backend& device, Count count, ArrayView<std::int64_t> out);

/// *count = value, in a kernel that takes a while; then out[i] = i*i + 1 for i < *count, in one that reads
/// the count ahead.
template <class Backend>
void writeSquaresOf(Backend& device, int value, int* count, ArrayView<std::int64_t> out);

/// counters[values[i] mod counters.size] grows by values[i].
template <class Backend>
void addToCounters(Backend& device, Count count, ArrayView<const int> values, ArrayView<int> counters);

inline constexpr std::int64_t kFewTeams = 1000;

/// out[i] = Σ_k (i + k) for k < 100, by teams of 1, 2, 8 or 32 where there are at most kFewTeams. lanes[i]
/// has a bit for every thread of the team, or is 0 where Team::ask does not tell the even ones.
template <class Backend>
void sumInTeams(Backend& device, Count count, int size, ArrayView<float> out, ArrayView<int> lanes);

template <class Backend>
void sum(Backend& device, Count count, ArrayView<const float> values, float* result);

template <class Backend>
void sum(Backend& device, Count count, ArrayView<const int> values, std::int64_t* result);

/// sums[k] of the values whose keys are k; none has a key below 0.
template <class Backend>
void sumByKey(Backend& device, Count count, ArrayView<const float> values, ArrayView<const int> keys,
              ArrayView<float> sums);

/// The sum of the values that have the key, 0 for each other.
template <class Backend>
void sumOfKey(Backend& device, Count count, ArrayView<const float> values, ArrayView<const int> keys, int key,
              float* result);

struct SixNumbers {
  double numbers[6];
};
using SixSums = ExactSums<SixNumbers>;

/// 1 to 6 times each value.
WEIR_HD inline SixSums sixTimes(float value) {
  SixNumbers times;
  for (int k = 0; k < 6; ++k) times.numbers[k] = (k + 1) * double(value);
  return {times, 1};
}

/// Results of more than 128 bytes: *all of the values, and byKey[k] of those whose keys are k.
template <class Backend>
void sixSums(Backend& device, Count count, ArrayView<const float> values, ArrayView<const int> keys,
             SixSums* all, ArrayView<SixSums> byKey);

/// The box around points; a result that is not a plain number.
template <class Backend>
void boundingBox(Backend& device, Count count, ArrayView<const Vec3f> points, Aabb* result);

/// Keeps the multiples of `divisor`.
template <class Backend>
void keepMultiples(Backend& device, Count count, ArrayView<const int> values, int divisor,
                   ArrayView<int> indices, int* kept);

template <class Backend>
void sortByCell(Backend& device, CellSort& sort, Count count, int cells, ArrayView<const int> keys,
                int* kept);

}  // namespace weir::test
