#include "nodes/fluid_surface/particle_kernels.h"
#include "nodes/fluid_surface/symmetric_eigen.h"

namespace weir {

namespace {

constexpr float kPi = 3.14159265358979f;
constexpr float kNormalization = 315 / (64 * kPi);  // ∫ W = 1
constexpr float kVariance = 0.15f;                  // ∫ w·x² / ∫ w over a ball of radius 1
constexpr float kLeastAxis = 0.25f;
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

struct UniteBoxes {
  WEIR_HD Aabb operator()(const Aabb& a, const Aabb& b) const { return {min(a.lo, b.lo), max(a.hi, b.hi)}; }
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

struct Reorder {
  ArrayView<const Vec3f> positions;
  ArrayView<const int> order;
  ArrayView<Vec3f> sorted;
  WEIR_HD void operator()(std::int64_t k) const { sorted[k] = positions[order[k]]; }
};

/// Weighted sums over the particles near one, seen from it.
struct Moments {
  float weight = 0;
  Vec3f first;
  float xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  WEIR_HD void add(float w, const Vec3f& d) {
    weight += w;
    const Vec3f wd = w * d;
    first += wd;
    xx += wd.x * d.x, yy += wd.y * d.y, zz += wd.z * d.z;
    xy += wd.x * d.y, xz += wd.x * d.z, yz += wd.y * d.z;
  }
  WEIR_HD Vec3f mean() const { return first / weight; }
  WEIR_HD SymmetricMatrix covariance() const {
    const double s = 1.0 / double(weight);
    SymmetricMatrix c{s * double(xx), s * double(yy), s * double(zz),
                      s * double(xy), s * double(xz), s * double(yz)};
    c.addProduct(-s * s, {first.x, first.y, first.z});
    return c;
  }
};

struct MakeKernel {
  ArrayView<const Vec3f> positions;
  ArrayView<const int> cellStart;
  CellGrid grid;
  KernelSettings settings;
  ArrayView<ParticleKernel> kernels;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    const Moments moments = momentsAt(p);
    const float share = moments.weight / fullWeight();
    const float blend = clamped((share - kLoneShare) / (kFullShare - kLoneShare), 0, 1);
    kernels[i] = kernelOf(p + settings.smoothing * moments.mean(), moments.covariance(), blend);
  }

 private:
  WEIR_HD static float clamped(float x, float lo, float hi) { return x < lo ? lo : (x > hi ? hi : x); }

  /// Σ w with one particle in each d³: ∫ w = 2π/3·R³.
  WEIR_HD float fullWeight() const {
    const float ratio = settings.radius / settings.spacing;
    return 2 * kPi / 3 * ratio * ratio * ratio;
  }

  WEIR_HD Moments momentsAt(const Vec3f& p) const {
    Moments moments;
    const Vec3i cell = grid.cellOf(p);
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int c =
              grid.index({CellGrid::step(cell.x, dx, grid.cells.x), CellGrid::step(cell.y, dy, grid.cells.y),
                          CellGrid::step(cell.z, dz, grid.cells.z)});
          addCell(cellStart[c], cellStart[c + 1], p, moments);
        }
    return moments;
  }

  WEIR_HD void addCell(int begin, int end, const Vec3f& p, Moments& moments) const {
    const float inverse = 1 / settings.radius;
    for (int j = begin; j < end; ++j) {
      const Vec3f d = positions[j] - p;
      const float q2 = dot(d, d) * inverse * inverse;
      if (q2 < 1) moments.add(1 - q2 * sqrtf(q2), d);
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
      const float own = axisOf(eigen.values[k], usual), least = longest / settings.anisotropy;
      const float full = clamped(own > least ? own : least, kLeastAxis, kLongestAxis);
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
  sorted_.resizeDiscarding(count);
  parallelFor(device, "surface reorder", Count(count, kept_.data()),
              Reorder{positions, sort_.order(), sorted_.view()});
}

template <class Backend>
void ParticleKernels::makeOn(Backend& device, const CellGrid& grid, const KernelSettings& settings) {
  parallelFor(device, "surface kernels", size_,
              MakeKernel{std::as_const(sorted_).view(), sort_.start(), grid, settings, kernels_.view()});
}

template void ParticleKernels::boundOn(ThisBackend&, ArrayView<const Vec3f>, std::int64_t, float);
template void ParticleKernels::sortOn(ThisBackend&, ArrayView<const Vec3f>, std::int64_t, const CellGrid&,
                                      float);
template void ParticleKernels::makeOn(ThisBackend&, const CellGrid&, const KernelSettings&);

}  // namespace weir
