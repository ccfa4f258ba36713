// The shapes of particles by which a surface is found: ellipsoids that lie along the fluid (Yu and Turk 2013,
// "Reconstructing surfaces of particle-based fluids using anisotropic kernels").
//
// With weights w_ij = 1 − (r_ij/h)³ of the particles within h, the particle itself included, a particle has
//
//   mean          m_i = Σ w_ij·x_j / Σ w_ij
//   centre        c_i = (1 − λ)·x_i + λ·m_i
//   covariance    C_i = Σ w_ij·(x_j − m_i)(x_j − m_i)ᵀ / Σ w_ij = Q·diag(s_1, s_2, s_3)·Qᵀ, s_1 the largest
//   axes          a_k = max(√s_k, √s_1/a) / √s̄, s̄ = 0.15·h², what s is within fluid on all sides
//   field         φ(x) = Σ_i V0·W(|G_i·(x − c_i)|)·det G_i,  G_i = Q·diag(1/a_k)·Qᵀ/h,
//                 W(q) = 315/(64π)·(1 − q²)³
//
// So φ is about 1 in fluid and 0 outside. Where the paper takes s for the axes this takes its root, as s is
// the square of a length: kernels at a surface are then less flat, and reach over the way that the mean has
// moved their centres inwards. A particle with few others near it is a ball with a_k = a_0. The paper changes
// from one to the other at a number of neighbours; here the axes are blended while Σ w grows from 0.1 to 0.3
// of what it is in full fluid, so nothing jumps as particles come and go. In the same way what is not full
// fluid may be left out, as spray: φ then is the sum of (1 − s_i) times the kernels, where the share s_i
// falls from 1 to 0.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/cell_sort.h"
#include "framework/neighbors/cell_grid.h"

namespace WEIR_API weir {

struct KernelSettings {
  float spacing = 0;      ///< d, m; V0 = d³
  float radius = 0;       ///< h, m
  float smoothing = 0;    ///< λ, from 0 to 1
  float anisotropy = 1;   ///< a, at least 1
  float loneAxis = 0.5f;  ///< a_0
  bool leavesSpray = false;
};

/// V0·W(|G·(x − c)|)·det G of one particle, as q² = (x − c)ᵀ·M·(x − c).
struct ParticleKernel {
  Vec3f center;                  ///< c, m
  float weight = 0;              ///< V0·315/(64π)·det G
  float xx, yy, zz, xy, xz, yz;  ///< M = GᵀG, 1/m²
  Vec3f reach;                   ///< half the box of the ellipsoid, m; below 0: there is none
};

class ParticleKernels {
 public:
  explicit ParticleKernels(Device& device)
      : sort_(device),
        columns_(device),
        kept_(device, 1),
        box_(device, 1),
        kernels_(device),
        spray_(device) {}

  /// Makes them for the first `count` of these positions. Those that are not finite, or farther than
  /// `farthest` from the origin along any axis, have none. Waits for the device.
  void make(Device& device, ArrayView<const Vec3f> positions, std::int64_t count,
            const KernelSettings& settings, float farthest);

  /// Bytes on the device for that many particles.
  static double memoryFor(double particles);

  /// How many there are.
  std::int64_t size() const { return size_; }
  const Array<ParticleKernel>& array() const { return kernels_; }
  /// Of each kernel: the number of its particle, and the share s of it that is spray (if that is left out).
  ArrayView<const int> particles() const { return sort_.order(); }
  ArrayView<const float> spray() const { return spray_.view(); }

 private:
  template <class Backend>
  void boundOn(Backend& device, ArrayView<const Vec3f> positions, std::int64_t count, float farthest);
  template <class Backend>
  void sortOn(Backend& device, ArrayView<const Vec3f> positions, std::int64_t count, const CellGrid& grid,
              float farthest);
  /// Of `count` positions, as sorted before.
  template <class Backend>
  void makeOn(Backend& device, const CellGrid& grid, std::int64_t count, const KernelSettings& settings);

  CellSort sort_;
  Array<float> columns_;  // x, y and z of the sorted particles
  Array<int> kept_;
  Array<Aabb> box_;
  Array<ParticleKernel> kernels_;
  Array<float> spray_;
  std::int64_t size_ = 0;
};

}  // namespace weir
