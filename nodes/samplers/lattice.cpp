#include "nodes/samplers/lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/random.h"
#include "framework/compute/cpu_threads.h"

namespace weir {

namespace {

Lattice centredAt(const Vec3d& center, const Vec3d& count, double spacing) {
  if (!(count.x * count.y * count.z <= Lattice::kMaxNodes))
    throw sceneError(
        fmt::format("a spacing of {:.6g} m makes a lattice of {:.7g} x {:.7g} x {:.7g} = {:.3g} nodes",
                    spacing, count.x, count.y, count.z, count.x * count.y * count.z),
        fmt::format("at most {:.0f}, the largest number of particles", Lattice::kMaxNodes),
        "make the fluid's spacing larger or the region smaller");
  const Vec3d ones{1, 1, 1};
  return {center - 0.5 * spacing * (count - ones),
          spacing,
          {static_cast<std::int64_t>(count.x), static_cast<std::int64_t>(count.y),
           static_cast<std::int64_t>(count.z)}};
}

struct Sampling {
  const Lattice& lattice;
  const Jitter& jitter;
  const std::function<bool(const Vec3f&)>& inside;
  const Displacement& displacement;
  std::vector<std::vector<Vec3f>> chunks{};
  static constexpr std::int64_t kChunk = 16384;  // nodes

  Vec3<std::int64_t> node(std::int64_t index) const {
    const Vec3<std::int64_t>& n = lattice.count;
    return {index % n.x, index / n.x % n.y, index / (n.x * n.y)};
  }

  Vec3f position(std::int64_t index) const {
    const Vec3<std::int64_t> n = node(index);
    Vec3d at{static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
    if (jitter.share > 0)
      for (int axis = 0; axis < 3; ++axis)
        at[axis] += jitter.share * noise(jitter.seed, static_cast<std::uint64_t>(3 * index + axis));
    at = lattice.first + lattice.spacing * at;
    return {static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)};
  }

  Vec3f displaced(std::int64_t index, const Vec3f& from) const {
    if (!displacement) return from;
    const Vec3<std::int64_t> n = node(index);
    return from + static_cast<float>(lattice.spacing) * displacement(n.x, n.y, n.z);
  }

  void fill(std::int64_t chunk) {
    std::vector<Vec3f>& points = chunks[static_cast<std::size_t>(chunk)];
    const std::int64_t end = std::min((chunk + 1) * kChunk, lattice.size());
    for (std::int64_t i = chunk * kChunk; i < end; ++i) {
      const Vec3f p = position(i);
      if (!inside || inside(p)) points.push_back(displaced(i, p));
    }
  }
};

}  // namespace

Lattice Lattice::inBox(const Aabb& box, float spacing) {
  const Vec3d lo{box.lo.x, box.lo.y, box.lo.z}, hi{box.hi.x, box.hi.y, box.hi.z};
  Vec3d count;
  for (int axis = 0; axis < 3; ++axis)
    count[axis] = std::max(1.0, std::round((hi[axis] - lo[axis]) / spacing));
  return centredAt(0.5 * (lo + hi), count, spacing);
}

Lattice Lattice::around(const Vec3f& center, float reach, float spacing) {
  const double count = 1 + 2 * std::floor(double(reach) / spacing);
  return centredAt({center.x, center.y, center.z}, {count, count, count}, spacing);
}

std::vector<Vec3f> sampleLattice(const Lattice& lattice, const Jitter& jitter, int threads,
                                 const std::function<bool(const Vec3f&)>& inside,
                                 const Displacement& displacement) {
  Sampling sampling{lattice, jitter, inside, displacement};
  const std::int64_t chunks = (lattice.size() + Sampling::kChunk - 1) / Sampling::kChunk;
  sampling.chunks.resize(static_cast<std::size_t>(chunks));
  CpuThreads(threads).run(
      chunks, [](void* self, std::int64_t chunk) { static_cast<Sampling*>(self)->fill(chunk); }, &sampling);
  std::size_t count = 0;
  for (const auto& chunk : sampling.chunks) count += chunk.size();
  std::vector<Vec3f> points;
  points.reserve(count);
  for (auto& chunk : sampling.chunks) {
    points.insert(points.end(), chunk.begin(), chunk.end());
    std::exchange(chunk, {});  // both would be twice the memory
  }
  return points;
}

}  // namespace weir
