#include "nodes/fluid_surface/kernel_field.h"
#include "framework/compute/lanes.h"
#include "framework/compute/reductions.h"

namespace weir {

namespace {

/// The nodes in the box of a kernel.
struct NodeRange {
  Vec3i lo, hi;

  WEIR_HD NodeRange(const ParticleKernel& kernel, float inverseCell) {
    const Vec3f from = inverseCell * (kernel.center - kernel.reach),
                to = inverseCell * (kernel.center + kernel.reach);
    lo = {static_cast<int>(ceilf(from.x)), static_cast<int>(ceilf(from.y)), static_cast<int>(ceilf(from.z))};
    hi = {static_cast<int>(floorf(to.x)), static_cast<int>(floorf(to.y)), static_cast<int>(floorf(to.z))};
  }
};

/// The blocks of all cells with a corner in the box of a kernel.
struct BlockRange {
  Vec3i lo, hi;

  WEIR_HD BlockRange(const ParticleKernel& kernel, float inverseCell) {
    const NodeRange nodes(kernel, inverseCell);
    lo = {(nodes.lo.x - 1) >> 3, (nodes.lo.y - 1) >> 3, (nodes.lo.z - 1) >> 3};
    hi = {nodes.hi.x >> 3, nodes.hi.y >> 3, nodes.hi.z >> 3};
  }
  WEIR_HD int count() const {
    const Vec3i n = hi - lo;
    return n.x < 0 || n.y < 0 || n.z < 0 ? 0 : (n.x + 1) * (n.y + 1) * (n.z + 1);
  }
};

struct CountBlocks {
  ArrayView<const ParticleKernel> kernels;
  float inverseCell;
  ArrayView<int> counts;
  WEIR_HD void operator()(std::int64_t i) const { counts[i] = BlockRange(kernels[i], inverseCell).count(); }
};

struct CountOf {
  ArrayView<const int> counts;
  WEIR_HD std::int64_t operator()(std::int64_t i) const { return counts[i]; }
};

struct ListBlocks {
  ArrayView<const ParticleKernel> kernels;
  float inverseCell;
  ArrayView<const int> first;
  ArrayView<std::uint64_t> keys;
  ArrayView<int> particles;

  WEIR_HD void operator()(std::int64_t i) const {
    const BlockRange blocks(kernels[i], inverseCell);
    std::int64_t at = first[i];
    for (int z = blocks.lo.z; z <= blocks.hi.z; ++z)
      for (int y = blocks.lo.y; y <= blocks.hi.y; ++y)
        for (int x = blocks.lo.x; x <= blocks.hi.x; ++x, ++at) {
          keys[at] = BlockKey::of({x, y, z});
          particles[at] = static_cast<int>(i);
        }
  }
};

struct IsHead {
  ArrayView<const std::uint64_t> keys;
  WEIR_HD bool operator()(std::int64_t i) const { return i == 0 || keys[i] != keys[i - 1]; }
};

struct CopyKeys {
  ArrayView<const std::uint64_t> keys;
  ArrayView<const int> heads;
  ArrayView<std::uint64_t> blocks;
  WEIR_HD void operator()(std::int64_t b) const { blocks[b] = keys[heads[b]]; }
};

/// A kernel in the coordinates of a block, in cells.
struct LocalKernel {
  Vec3f center;
  float weight, xx, yy, zz, xy, xz, yz;

  WEIR_HD LocalKernel(const ParticleKernel& k, const Vec3i& origin, float cell) {
    const auto seen = [cell](float x, int block) { return (x - static_cast<float>(block) * cell) / cell; };
    center = {seen(k.center.x, origin.x), seen(k.center.y, origin.y), seen(k.center.z, origin.z)};
    const float square = cell * cell;
    weight = k.weight;
    xx = square * k.xx, yy = square * k.yy, zz = square * k.zz;
    xy = square * k.xy, xz = square * k.xz, yz = square * k.yz;
  }

  /// Adds the kernel to the nodes of a row along x.
  WEIR_HD void addTo(float* row, int y, int z) const {
    const float dy = static_cast<float>(y) - center.y, dz = static_cast<float>(z) - center.z;
    const float along = xy * dy + xz * dz;
    const float across = yy * dy * dy + 2 * yz * dy * dz + zz * dz * dz;
    // The least that q² is on this line.
    if (across * xx - along * along >= xx) return;
    static_assert(BlockKey::kSide % kPack == 0);
    for (int first = 0; first < BlockKey::kSide; first += kPack) {
      const Pack x = static_cast<float>(first) + countingPack();
      storePack(row + first, loadPack(row + first) + valueAt(x - Pack(center.x), along, across));
    }
  }

 private:
  template <class T>
  WEIR_HD T valueAt(const T& dx, float along, float across) const {
    const T t = positivePart(1 - ((xx * dx + 2 * along) * dx + across));
    return weight * t * t * t;
  }
};

struct SumBlock {
  ArrayView<const ParticleKernel> kernels;
  float cellSize;
  ArrayView<const std::uint64_t> keys;
  ArrayView<const int> heads, particles;
  std::int64_t pairs;
  ArrayView<float> values;

  /// The threads of a team share the rows of the block.
  WEIR_HD void operator()(std::int64_t b, const Team& team) const {
    float* block = values.data + b * BlockKey::kNodes;
    for (int row = team.lane; row < 64; row += team.size)
      for (int x = 0; x < BlockKey::kSide; ++x) block[row * BlockKey::kSide + x] = 0;
    const Vec3i place = BlockKey::coordinates(keys[b]);
    const Vec3i origin{place.x * BlockKey::kSide, place.y * BlockKey::kSide, place.z * BlockKey::kSide};
    const std::int64_t end = b + 1 < keys.size ? heads[b + 1] : pairs;
    for (std::int64_t p = heads[b]; p < end; ++p) add(kernels[particles[p]], origin, team, block);
  }

 private:
  WEIR_HD void add(const ParticleKernel& kernel, const Vec3i& origin, const Team& team, float* block) const {
    const NodeRange nodes(kernel, 1 / cellSize);
    const LocalKernel local(kernel, origin, cellSize);
    const int yLo = larger(nodes.lo.y - origin.y, 0), yHi = smaller(nodes.hi.y - origin.y, 7);
    const int zLo = larger(nodes.lo.z - origin.z, 0), zHi = smaller(nodes.hi.z - origin.z, 7);
    for (int z = zLo; z <= zHi; ++z)
      for (int y = yLo; y <= yHi; ++y) {
        const int row = z * BlockKey::kSide + y;
        if ((row & (team.size - 1)) == team.lane) local.addTo(block + row * BlockKey::kSide, y, z);
      }
  }
  WEIR_HD static int larger(int a, int b) { return a > b ? a : b; }
  WEIR_HD static int smaller(int a, int b) { return a < b ? a : b; }
};

}  // namespace

template <class Backend>
void KernelField::countOn(Backend& device, const ParticleKernels& kernels, float cellSize) {
  const std::int64_t n = kernels.size();
  parallelFor(device, "surface blocks", n, CountBlocks{kernels.array().view(), 1 / cellSize, counts_.view()});
  reduce(device, "surface pairs", n, std::int64_t{0}, CountOf{std::as_const(counts_).view()}, Plus{},
         pairCount_.data());
  exclusiveScan(device, std::as_const(counts_).view(), counts_.view(), n);
}

template <class Backend>
void KernelField::listOn(Backend& device, const ParticleKernels& kernels, float cellSize,
                         std::int64_t pairs) {
  keys_.resizeDiscarding(pairs);
  particles_.resizeDiscarding(pairs);
  heads_.resizeDiscarding(pairs);
  parallelFor(device, "surface lists", kernels.size(),
              ListBlocks{kernels.array().view(), 1 / cellSize, std::as_const(counts_).view(), keys_.view(),
                         particles_.view()});
  stableSortByKey(device, keys_.view(), particles_.view(), pairs);
  compact(device, "surface heads", pairs, IsHead{std::as_const(keys_).view()}, heads_.view(),
          headCount_.data());
}

template <class Backend>
void KernelField::sumOn(Backend& device, const ParticleKernels& kernels, std::int64_t pairs) {
  constexpr TeamPlan kTeams{32, std::numeric_limits<std::int64_t>::max()};
  parallelFor(device, "surface keys", grid_.blocks(),
              CopyKeys{std::as_const(keys_).view(), std::as_const(heads_).view(), grid_.keys().view()});
  parallelForTeams<kTeams>(
      device, "surface field", grid_.blocks(),
      SumBlock{kernels.array().view(), grid_.cellSize(), grid_.view().keys, std::as_const(heads_).view(),
               std::as_const(particles_).view(), pairs, grid_.values().view()});
}

template void KernelField::countOn(ThisBackend&, const ParticleKernels&, float);
template void KernelField::listOn(ThisBackend&, const ParticleKernels&, float, std::int64_t);
template void KernelField::sumOn(ThisBackend&, const ParticleKernels&, std::int64_t);

}  // namespace weir
