#include "nodes/samplers/lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/random.h"
#include "framework/compute/cpu_threads.h"
#include "framework/graph/setting_warning.h"

namespace weir {

namespace {

Lattice centredAt(const Vec3d& center, const Vec3d& count, double spacing, int ranks) {
  if (!(count.x * count.y * count.z <= Lattice::kMaxNodes * ranks))
    throw sceneError(
        fmt::format("a spacing of {:.6g} m makes a lattice of {:.7g} x {:.7g} x {:.7g} = {:.3g} nodes",
                    spacing, count.x, count.y, count.z, count.x * count.y * count.z),
        fmt::format("at most {:.0f}, the largest number of particles{}", Lattice::kMaxNodes * ranks,
                    ranks > 1 ? fmt::format(" of {} ranks", ranks) : ""),
        "make the fluid's spacing larger or the region smaller");
  const Vec3d ones{1, 1, 1};
  return {center - 0.5 * spacing * (count - ones),
          spacing,
          {static_cast<std::int64_t>(count.x), static_cast<std::int64_t>(count.y),
           static_cast<std::int64_t>(count.z)}};
}

struct Node {
  Vec3<std::int64_t> index;
  Vec3d at;  // m
};

/// floor((a·b - less)/c) of numbers whose product may need more than 64 bits.
std::int64_t ratio(std::int64_t a, std::int64_t b, std::int64_t less, std::int64_t c) {
  __extension__ using Wide = __int128;
  return static_cast<std::int64_t>((Wide{a} * b - less) / c);
}

/// The node of that number in a lattice with rows. Row r begins with number floor(r·nodes/rows).
Node nodeInRows(const Lattice& lattice, std::int64_t number) {
  const Lattice::Rows& of = *lattice.rows;
  const std::int64_t rows = lattice.count.y * lattice.count.z;
  const std::int64_t row = ratio(number + 1, rows, 1, of.nodes);
  const std::int64_t begin = ratio(row, of.nodes, 0, rows), end = ratio(row + 1, of.nodes, 0, rows);
  const Vec3<std::int64_t> index{number - begin, row % lattice.count.y, row / lattice.count.y};
  const Vec3<std::int64_t> count{end - begin, lattice.count.y, lattice.count.z};
  Vec3d at;
  for (int axis = 0; axis < 3; ++axis)
    at[axis] = of.low[axis] + (double(index[axis]) + 0.5) * of.size[axis] / double(count[axis]);
  return {index, at};
}

/// How many rows along y and z make distances the most alike along all axes, in a box of that size in
/// spacings.
std::pair<double, double> rowsIn(const Vec3d& size) {
  std::pair<double, double> best;
  double least = std::numeric_limits<double>::infinity();
  for (const double y : {std::floor(size.y), std::ceil(size.y)})
    for (const double z : {std::floor(size.z), std::ceil(size.z)}) {
      const double alongY = std::log(size.y / y), alongZ = std::log(size.z / z);
      const double most = std::max({std::abs(alongY), std::abs(alongZ), std::abs(alongY + alongZ)});
      if (most < least) {
        least = most;
        best = {y, z};
      }
    }
  return best;
}

struct Sampling {
  const Lattice& lattice;
  const LatticeShare& share;
  const Jitter& jitter;
  const std::function<bool(const Vec3f&)>& inside;
  const Displacement& displacement;
  LatticePoints chunks{};

  Vec3d jittered(std::int64_t number) const {
    Vec3d moved;
    if (jitter.share > 0)
      for (int axis = 0; axis < 3; ++axis)
        moved[axis] = jitter.share * noise(jitter.seed, static_cast<std::uint64_t>(3 * number + axis));
    return moved;
  }

  Node node(std::int64_t number) const {
    if (lattice.rows) {
      Node found = nodeInRows(lattice, number);
      found.at += lattice.spacing * jittered(number);
      return found;
    }
    const Vec3<std::int64_t>& n = lattice.count;
    const Vec3<std::int64_t> index{number % n.x, number / n.x % n.y, number / (n.x * n.y)};
    const Vec3d at{static_cast<double>(index.x), static_cast<double>(index.y), static_cast<double>(index.z)};
    return {index, lattice.first + lattice.spacing * (at + jittered(number))};
  }

  Vec3f displaced(const Vec3<std::int64_t>& index, const Vec3f& from) const {
    if (!displacement) return from;
    return from + static_cast<float>(lattice.spacing) * displacement(index.x, index.y, index.z);
  }

  void fill(std::int64_t chunk) {
    std::vector<Vec3f>& points = chunks[static_cast<std::size_t>(chunk)];
    const std::int64_t begin = (share.turn + chunk * share.turns) * LatticeShare::kChunk,
                       end = std::min(begin + LatticeShare::kChunk, lattice.size());
    for (std::int64_t i = begin; i < end; ++i) {
      const Node n = node(i);
      const Vec3f p{static_cast<float>(n.at.x), static_cast<float>(n.at.y), static_cast<float>(n.at.z)};
      if (!inside || inside(p)) points.push_back(displaced(n.index, p));
    }
  }
};

}  // namespace

Lattice Lattice::inBox(const Aabb& box, float spacing, int ranks) {
  const Vec3d lo{box.lo.x, box.lo.y, box.lo.z}, hi{box.hi.x, box.hi.y, box.hi.z};
  Vec3d count;
  for (int axis = 0; axis < 3; ++axis)
    count[axis] = std::max(1.0, std::round((hi[axis] - lo[axis]) / spacing));
  return centredAt(0.5 * (lo + hi), count, spacing, ranks);
}

Lattice Lattice::filling(const Aabb& box, float spacing, int ranks) {
  constexpr double kThin = kMinSpacings * (1 - kSettingRounding);
  Lattice lattice = inBox(box, spacing, ranks);
  const Vec3d low{box.lo.x, box.lo.y, box.lo.z}, high{box.hi.x, box.hi.y, box.hi.z};
  const Vec3d size = (1 / double(spacing)) * (high - low);
  const double volume = size.x * size.y * size.z;
  if (std::abs(double(lattice.size()) - volume) <= kExact * volume) return lattice;
  const double nodes = std::round(volume);
  if (std::min({size.x, size.y, size.z}) < kThin || nodes > kMaxNodes * ranks) return lattice;
  const auto [y, z] = rowsIn(size);
  lattice.count = {static_cast<std::int64_t>(std::ceil(nodes / (y * z))), static_cast<std::int64_t>(y),
                   static_cast<std::int64_t>(z)};
  lattice.rows = {low, high - low, static_cast<std::int64_t>(nodes)};
  return lattice;
}

Lattice Lattice::around(const Vec3f& center, float reach, float spacing, const Vec3<bool>& between,
                        int ranks) {
  const double nodes = double(reach) / spacing;
  Vec3d count;
  for (int axis = 0; axis < 3; ++axis)
    count[axis] = between[axis] ? 2 * std::floor(nodes + 0.5) : 1 + 2 * std::floor(nodes);
  return centredAt({center.x, center.y, center.z}, count, spacing, ranks);
}

LatticePoints sampleLattice(const Lattice& lattice, const LatticeShare& share, const Jitter& jitter,
                            int threads, const std::function<bool(const Vec3f&)>& inside,
                            const Displacement& displacement) {
  Sampling sampling{lattice, share, jitter, inside, displacement};
  const std::int64_t chunks = share.chunksOf(lattice.size());
  sampling.chunks.resize(static_cast<std::size_t>(chunks));
  CpuThreads(threads).run(
      chunks, [](void* self, std::int64_t chunk) { static_cast<Sampling*>(self)->fill(chunk); }, &sampling);
  return std::move(sampling.chunks);
}

}  // namespace weir
