#include "plugins/views/lone_particles.h"

#include <bit>
#include <cmath>

#include "framework/base/random.h"
#include "framework/compute/atomics.h"
#include "framework/compute/parallel.h"
#include "framework/compute/reductions.h"

namespace weir::rendering {

namespace {

constexpr int kTables = 3;
constexpr std::uint64_t kPerParticle = 4;  // entries of a table, at least

struct CellCounts {
  std::uint32_t* counts;
  std::uint64_t entries;  // of each table, a power of two
  float cell;             // m

  /// Of the lower of the two cells along an axis that are nearest.
  WEIR_HD double lower(float x) const { return std::floor(double(x) / double(cell) - 0.5); }

  WEIR_HD double own(float x) const { return std::floor(double(x) / double(cell)); }

  WEIR_HD static std::uint64_t part(double c) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(c));
  }
  WEIR_HD std::uint32_t* entry(int table, double x, double y, double z) const {
    const std::uint64_t key =
        splitMix64(splitMix64(static_cast<std::uint64_t>(table), part(x)) ^ part(y), part(z));
    return counts + static_cast<std::uint64_t>(table) * entries + (key & (entries - 1));
  }
};

struct CountCell {
  CellCounts cells;
  ArrayView<const Vec3f> positions;
  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    if (!isFinite(p)) return;
    for (int table = 0; table < kTables; ++table)
      atomicAdd(cells.entry(table, cells.own(p.x), cells.own(p.y), cells.own(p.z)), 1);
  }
};

struct IsLone {
  CellCounts cells;
  ArrayView<const Vec3f> positions;
  bool wanted;  // or the others
  WEIR_HD bool operator()(std::int64_t i) const { return isLone(positions[i]) == wanted; }

  WEIR_HD bool isLone(const Vec3f& p) const {
    if (!isFinite(p)) return false;
    const double x = cells.lower(p.x), y = cells.lower(p.y), z = cells.lower(p.z);
    std::uint32_t near = 0;
    for (int k = 0; k < 8; ++k) {
      near += countOf(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
      if (near > 2) return false;
    }
    return true;
  }

  WEIR_HD std::uint32_t countOf(double x, double y, double z) const {
    std::uint32_t least = *cells.entry(0, x, y, z);
    for (int table = 1; table < kTables; ++table) {
      const std::uint32_t count = *cells.entry(table, x, y, z);
      least = count < least ? count : least;
    }
    return least;
  }
};

}  // namespace

template <class Backend>
void LoneParticles::findOn(Backend& device, ArrayView<const Vec3f> positions, float cell) {
  const std::uint64_t entries = std::bit_ceil(kPerParticle * static_cast<std::uint64_t>(positions.size));
  counts_.resizeDiscarding(static_cast<std::int64_t>(kTables * entries));
  counts_.fillZero();
  const CellCounts cells{counts_.data(), entries, cell};
  parallelFor(device, "count cells", positions.size, CountCell{cells, positions});
  compact(device, "lone", positions.size, IsLone{cells, positions, true}, lone_.view(), kept_.data());
  compact(device, "not lone", positions.size, IsLone{cells, positions, false}, others_.view(),
          kept_.data() + 1);
}

template void LoneParticles::findOn(ThisBackend&, ArrayView<const Vec3f>, float);

}  // namespace weir::rendering
