#include "tests/framework/compute/kernels.h"

#include "framework/compute/reduce_by_key.h"

namespace weir::test {
namespace {

struct WriteSquare {
  ArrayView<std::int64_t> out;
  WEIR_HD void operator()(std::int64_t i) const { out[i] = i * i + 1; }
};

struct WriteSquareAhead : WriteSquare {
  static constexpr Standing kReadsAhead = Standing::kCounts;
};

struct SetLate {
  int value;
  int* to;

  WEIR_HD void operator()(std::int64_t) const {
    unsigned x = static_cast<unsigned>(value) + 1;
    for (int k = 0; k < 10000; ++k) x = x * 1664525u + 1013904223u;
    *to = x == 1 ? value + 1 : value;
  }
};

struct AddToCounter {
  ArrayView<const int> values;
  ArrayView<int> counters;
  WEIR_HD void operator()(std::int64_t i) const {
    atomicAdd(&counters[values[i] % counters.size], values[i]);
  }
};

struct SumInTeam {
  ArrayView<float> out;
  ArrayView<int> lanes;
  WEIR_HD void operator()(std::int64_t i, const Team& team) const {
    float mine = 0;
    for (int k = team.lane; k < 100; k += team.size) mine += float(i + k);
    const float all = team.sum(mine);
    const int united = team.unite(static_cast<int>(1u << team.lane));
    const bool agree = team.ask(team.lane % 2 == 0) == (0x55555555u & static_cast<unsigned>(united));
    if (team.lane == team.size - 1) out[i] = all, lanes[i] = agree ? united : 0;
  }
};

template <class T>
struct Element {
  ArrayView<const T> values;
  WEIR_HD T operator()(std::int64_t i) const { return values[i]; }
};

struct Plus {
  template <class T>
  WEIR_HD T operator()(const T& a, const T& b) const {
    return a + b;
  }
};

struct ElementByKey {
  ArrayView<const float> values;
  ArrayView<const int> keys;
  template <class Give>
  WEIR_HD void operator()(std::int64_t i, const Give& give) const {
    if (keys[i] >= 0) give(keys[i], [&] { return values[i]; });
  }
};

struct ElementOfKey {
  ArrayView<const float> values;
  ArrayView<const int> keys;
  int key;
  WEIR_HD float operator()(std::int64_t i) const { return keys[i] == key ? values[i] : 0.0f; }
};

struct SixTimes {
  ArrayView<const float> values;
  WEIR_HD SixSums operator()(std::int64_t i) const { return sixTimes(values[i]); }
};

struct SixTimesByKey {
  ArrayView<const float> values;
  ArrayView<const int> keys;
  template <class Give>
  WEIR_HD void operator()(std::int64_t i, const Give& give) const {
    if (keys[i] >= 0) give(keys[i], [&] { return sixTimes(values[i]); });
  }
};

struct PointBox {
  ArrayView<const Vec3f> points;
  WEIR_HD Aabb operator()(std::int64_t i) const { return {points[i], points[i]}; }
};

struct Union {
  WEIR_HD Aabb operator()(Aabb a, const Aabb& b) const {
    a.extend(b);
    return a;
  }
};

struct IsMultiple {
  ArrayView<const int> values;
  int divisor;
  WEIR_HD bool operator()(std::int64_t i) const { return values[i] % divisor == 0; }
};

}  // namespace

template <class Backend>
void writeSquares(Backend& device, Count count, ArrayView<std::int64_t> out) {
  parallelFor(device, "writeSquares", count, WriteSquare{out});
}

template <class Backend>
void writeSquaresOf(Backend& device, int value, int* count, ArrayView<std::int64_t> out) {
  parallelFor(device, "setLate", 1, SetLate{value, count});
  parallelFor(device, "writeSquares", {out.size, count}, WriteSquareAhead{out});
}

template <class Backend>
void sumInTeams(Backend& device, Count count, int size, ArrayView<float> out, ArrayView<int> lanes) {
  const auto launch = [&]<int kSize>(std::integral_constant<int, kSize>) {
    parallelForTeams<TeamPlan{kSize, kFewTeams}>(device, "sumInTeams", count, SumInTeam{out, lanes});
  };
  switch (size) {
    case 1:
      return launch(std::integral_constant<int, 1>{});
    case 2:
      return launch(std::integral_constant<int, 2>{});
    case 8:
      return launch(std::integral_constant<int, 8>{});
    case 32:
      return launch(std::integral_constant<int, 32>{});
    default:
      WEIR_CHECK(size == 0);  // there is no test of others
  }
}

template <class Backend>
void addToCounters(Backend& device, Count count, ArrayView<const int> values, ArrayView<int> counters) {
  parallelFor(device, "addToCounters", count, AddToCounter{values, counters});
}

template <class Backend>
void sum(Backend& device, Count count, ArrayView<const float> values, float* result) {
  reduce(device, "sum", count, 0.0f, Element<float>{values}, Plus{}, result);
}

template <class Backend>
void sum(Backend& device, Count count, ArrayView<const int> values, std::int64_t* result) {
  reduce(device, "sum", count, std::int64_t{0}, Element<int>{values}, Plus{}, result);
}

template <class Backend>
void sumByKey(Backend& device, Count count, ArrayView<const float> values, ArrayView<const int> keys,
              ArrayView<float> sums) {
  reduceByKey(device, "sumByKey", count, sums.size, 0.0f, ElementByKey{values, keys}, Plus{}, sums.data);
}

template <class Backend>
void sumOfKey(Backend& device, Count count, ArrayView<const float> values, ArrayView<const int> keys, int key,
              float* result) {
  reduce(device, "sumOfKey", count, 0.0f, ElementOfKey{values, keys, key}, Plus{}, result);
}

template <class Backend>
void sixSums(Backend& device, Count count, ArrayView<const float> values, ArrayView<const int> keys,
             SixSums* all, ArrayView<SixSums> byKey) {
  reduce(device, "sixSums", count, SixSums{}, SixTimes{values}, Plus{}, all);
  reduceByKey(device, "sixSumsByKey", count, byKey.size, SixSums{}, SixTimesByKey{values, keys}, Plus{},
              byKey.data);
}

template <class Backend>
void boundingBox(Backend& device, Count count, ArrayView<const Vec3f> points, Aabb* result) {
  reduce(device, "boundingBox", count, Aabb{}, PointBox{points}, Union{}, result);
}

template <class Backend>
void keepMultiples(Backend& device, Count count, ArrayView<const int> values, int divisor,
                   ArrayView<int> indices, int* kept) {
  compact(device, "keepMultiples", count, IsMultiple{values, divisor}, indices, kept);
}

template <class Backend>
void sortByCell(Backend& device, CellSort& sort, Count count, int cells, ArrayView<const int> keys,
                int* kept) {
  sort.sort(device, count, cells, Element<int>{keys}, kept);
}

template void sumInTeams(ThisBackend&, Count, int, ArrayView<float>, ArrayView<int>);
template void writeSquaresOf(ThisBackend&, int, int*, ArrayView<std::int64_t>);
template void writeSquares(ThisBackend&, Count, ArrayView<std::int64_t>);
template void addToCounters(ThisBackend&, Count, ArrayView<const int>, ArrayView<int>);
template void sum(ThisBackend&, Count, ArrayView<const float>, float*);
template void sum(ThisBackend&, Count, ArrayView<const int>, std::int64_t*);
template void sumByKey(ThisBackend&, Count, ArrayView<const float>, ArrayView<const int>, ArrayView<float>);
template void sumOfKey(ThisBackend&, Count, ArrayView<const float>, ArrayView<const int>, int, float*);
template void sixSums(ThisBackend&, Count, ArrayView<const float>, ArrayView<const int>, SixSums*,
                      ArrayView<SixSums>);
template void boundingBox(ThisBackend&, Count, ArrayView<const Vec3f>, Aabb*);
template void keepMultiples(ThisBackend&, Count, ArrayView<const int>, int, ArrayView<int>, int*);
template void sortByCell(ThisBackend&, CellSort&, Count, int, ArrayView<const int>, int*);

}  // namespace weir::test
