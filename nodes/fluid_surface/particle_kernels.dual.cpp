#include "nodes/fluid_surface/particle_kernels.h"
#include "framework/base/clamped.h"
#include "framework/compute/lanes.h"
#include "framework/compute/reductions.h"
#include "nodes/fluid_surface/symmetric_eigen.h"

namespace weir {

namespace {

constexpr float kPi = 3.14159265358979f;
constexpr float kNormalization = 315 / (64 * kPi);  // ∫ W = 1
constexpr float kVariance = 0.15f;                  // ∫ w·x² / ∫ w over a ball of radius 1
constexpr float kMinAxis = 0.25f;
constexpr float kLongestAxis = 2;  // bounds what a kernel costs
// Shares of the sum of weights in full fluid. A layer of single particles has about 0.36.
constexpr float kLoneShare = 0.1f, kFullShare = 0.3f;

struct IsUsable {
  float farthest;
  WEIR_HD bool operator()(const Vec3f& p) const {
    return fabsf(p.x) <= farthest && fabsf(p.y) <= farthest && fabsf(p.z) <= farthest;
  }
};

struct UsableBox {
  ArrayView<const Vec3f> positions;
  IsUsable isUsable;
  WEIR_HD Aabb operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return isUsable(p) ? Aabb{p, p} : Aabb{};
  }
};

struct CellKey {
  ArrayView<const Vec3f> positions;
  IsUsable isUsable;
  CellGrid grid;
  WEIR_HD int operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return isUsable(p) ? grid.index(grid.cellOf(p)) : -1;
  }
};

/// The coordinates of the sorted particles in columns, so that eight of them are read at a time. Behind each
/// column there is room for eight more.
struct Columns {
  static constexpr std::int64_t kMore = 8;

  ArrayView<float> x, y, z;

  Columns(Array<float>& memory, std::int64_t particles) {
    const std::int64_t height = particles + kMore;
    memory.resizeDiscarding(3 * height);
    x = {memory.data(), height}, y = {memory.data() + height, height},
    z = {memory.data() + 2 * height, height};
  }
};

struct Reorder {
  ArrayView<const Vec3f> positions;
  ArrayView<const int> order;
  Columns sorted;
  WEIR_HD void operator()(std::int64_t k) const {
    const Vec3f p = positions[order[k]];
    sorted.x[k] = p.x, sorted.y[k] = p.y, sorted.z[k] = p.z;
  }
};

/// Weighted sums over the particles near one, seen from it. T is float, or a Pack of them.
template <class T>
struct Moments {
  T weight{}, x{}, y{}, z{}, xx{}, yy{}, zz{}, xy{}, xz{}, yz{};

  WEIR_HD void add(const T& w, const Vec3<T>& d) {
    const Vec3<T> wd{w * d.x, w * d.y, w * d.z};
    weight += w;
    x += wd.x, y += wd.y, z += wd.z;
    xx += wd.x * d.x, yy += wd.y * d.y, zz += wd.z * d.z;
    xy += wd.x * d.y, xz += wd.x * d.z, yz += wd.y * d.z;
  }
};

WEIR_HD Moments<float> sumOf(const Moments<Pack>& m) {
  return {sumOfPack(m.weight), sumOfPack(m.x),  sumOfPack(m.y),  sumOfPack(m.z),  sumOfPack(m.xx),
          sumOfPack(m.yy),     sumOfPack(m.zz), sumOfPack(m.xy), sumOfPack(m.xz), sumOfPack(m.yz)};
}

WEIR_HD Vec3f meanOf(const Moments<float>& m) {
  return Vec3f{m.x, m.y, m.z} / m.weight;
}

WEIR_HD SymmetricMatrix covarianceOf(const Moments<float>& m) {
  const double s = 1.0 / double(m.weight);
  SymmetricMatrix c{s * double(m.xx), s * double(m.yy), s * double(m.zz),
                    s * double(m.xy), s * double(m.xz), s * double(m.yz)};
  c.addProduct(-s * s, {m.x, m.y, m.z});
  return c;
}

struct MakeKernel {
  Columns sorted;
  ArrayView<const int> cellStart;
  CellGrid grid;
  KernelSettings settings;
  ArrayView<ParticleKernel> kernels;
  ArrayView<float> spray;  // none if that is not left out

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p{sorted.x[i], sorted.y[i], sorted.z[i]};
    const Moments<float> moments = momentsAt(p);
    const float share = moments.weight / fullWeight();
    const float blend = clamped((share - kLoneShare) / (kFullShare - kLoneShare), 0, 1);
    kernels[i] = kernelOf(p + settings.smoothing * meanOf(moments), covarianceOf(moments), blend);
    if (spray.size == 0) return;
    spray[i] = 1 - blend;
    kernels[i].weight *= blend;
    if (blend == 0) kernels[i].reach = -settings.radius * Vec3f{1, 1, 1};
  }

 private:
  /// Σ w with one particle in each d³: ∫ w = 2π/3·R³.
  WEIR_HD float fullWeight() const {
    const float ratio = settings.radius / settings.spacing;
    return 2 * kPi / 3 * ratio * ratio * ratio;
  }

  WEIR_HD Moments<float> momentsAt(const Vec3f& p) const {
    Moments<Pack> moments;
    const Vec3i cell = grid.cellOf(p);
    const bool inside = cell.x > 0 && cell.x + 1 < grid.cells.x;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy) {
        const int row = grid.index(
            {0, CellGrid::step(cell.y, dy, grid.cells.y), CellGrid::step(cell.z, dz, grid.cells.z)});
        if (inside) {
          // The cells of a row stand side by side.
          addRange(cellStart[row + cell.x - 1], cellStart[row + cell.x + 2], p, moments);
          continue;
        }
        for (int dx = -1; dx <= 1; ++dx) {
          const int c = row + CellGrid::step(cell.x, dx, grid.cells.x);
          addRange(cellStart[c], cellStart[c + 1], p, moments);
        }
      }
    return sumOf(moments);
  }

  WEIR_HD void addRange(int begin, int end, const Vec3f& p, Moments<Pack>& moments) const {
    const Pack inverseSquare(1 / (settings.radius * settings.radius));
    for (int j = begin; j < end; j += kPack) {
      const Vec3<Pack> d{loadPack(sorted.x.data + j) - p.x, loadPack(sorted.y.data + j) - p.y,
                         loadPack(sorted.z.data + j) - p.z};
      const Pack q2 = dot(d, d) * inverseSquare;
      const auto near = packBelow(j, end) & (q2 < Pack(1.0f));
      if (canSkip(near)) continue;
      // What is beyond the range may be NaN.
      moments.add(zeroUnless(near, 1 - q2 * sqrtf(q2)),
                  {zeroUnless(near, d.x), zeroUnless(near, d.y), zeroUnless(near, d.z)});
    }
  }

  /// The root of a variance over the usual one.
  WEIR_HD static float axisOf(double variance, float usual) {
    return variance > 0 ? sqrtf(static_cast<float>(variance) / usual) : 0;
  }

  WEIR_HD ParticleKernel kernelOf(const Vec3f& center, const SymmetricMatrix& covariance, float blend) const {
    const SymmetricEigen eigen = eigenOf(covariance);
    const float h = settings.radius, usual = kVariance * h * h;
    const float longest = axisOf(eigen.values.x, usual);
    ParticleKernel kernel{
        .center = center,
        .weight = settings.spacing * settings.spacing * settings.spacing * kNormalization / (h * h * h)};
    SymmetricMatrix inverse, squares;
    for (int k = 0; k < 3; ++k) {
      const float own = axisOf(eigen.values[k], usual), min = longest / settings.anisotropy;
      const float full = clamped(own > min ? own : min, kMinAxis, kLongestAxis);
      const float axis = settings.loneAxis + blend * (full - settings.loneAxis);
      const double length = double(h) * double(axis);
      inverse.addProduct(1 / (length * length), eigen.vectors[k]);
      squares.addProduct(length * length, eigen.vectors[k]);
      kernel.weight /= axis;
    }
    kernel.xx = static_cast<float>(inverse.xx), kernel.yy = static_cast<float>(inverse.yy);
    kernel.zz = static_cast<float>(inverse.zz), kernel.xy = static_cast<float>(inverse.xy);
    kernel.xz = static_cast<float>(inverse.xz), kernel.yz = static_cast<float>(inverse.yz);
    kernel.reach = {static_cast<float>(std::sqrt(squares.xx)), static_cast<float>(std::sqrt(squares.yy)),
                    static_cast<float>(std::sqrt(squares.zz))};
    return kernel;
  }
};

}  // namespace

template <class Backend>
void ParticleKernels::boundOn(Backend& device, ArrayView<const Vec3f> positions, std::int64_t count,
                              float farthest) {
  reduce(device, "surface bounds", count, Aabb{}, UsableBox{positions, {farthest}}, UniteBoxes{},
         box_.data());
}

template <class Backend>
void ParticleKernels::sortOn(Backend& device, ArrayView<const Vec3f> positions, std::int64_t count,
                             const CellGrid& grid, float farthest) {
  sort_.sort(device, count, grid.cellCount(), CellKey{positions, {farthest}, grid}, kept_.data());
  parallelFor(device, "surface reorder", Count(count, kept_.data()),
              Reorder{positions, sort_.order(), Columns(columns_, count)});
}

template <class Backend>
void ParticleKernels::makeOn(Backend& device, const CellGrid& grid, std::int64_t count,
                             const KernelSettings& settings) {
  parallelFor(
      device, "surface kernels", size_,
      MakeKernel{Columns(columns_, count), sort_.start(), grid, settings, kernels_.view(), spray_.view()});
}

template void ParticleKernels::boundOn(ThisBackend&, ArrayView<const Vec3f>, std::int64_t, float);
template void ParticleKernels::sortOn(ThisBackend&, ArrayView<const Vec3f>, std::int64_t, const CellGrid&,
                                      float);
template void ParticleKernels::makeOn(ThisBackend&, const CellGrid&, std::int64_t, const KernelSettings&);

}  // namespace weir
