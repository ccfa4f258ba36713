#include "nodes/particle_fluid/modules/xsph.h"

#include "framework/neighbors/motion_code.h"
#include "framework/neighbors/neighbor_sum.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/scratch.h"

namespace weir {

namespace {

/// Σ_j W(r_ij)·(v_j − v), and Σ_j W(r_ij).
template <class Index, class Velocity>
WEIR_HD Vec4<NumberAt<Index>> weightedDifferences(Index i, const NeighborView& neighbors,
                                                  const SpikyKernel& kernel, const Velocity& v,
                                                  const ArrayView<const Vec3f>& positions,
                                                  const ArrayView<const Vec3f>& velocities) {
  const auto p = read(positions, i);
  const auto difference = [&]<class T>(const auto&, const Vec3<T>& q, const Vec3<T>& u) {
    const Vec3<T> d{q.x - p.x, q.y - p.y, q.z - p.z};
    const T w = kernel.value(fastSqrt(dot(d, d)));
    return Vec4<T>{w * (u.x - v.x), w * (u.y - v.y), w * (u.z - v.z), w};
  };
  return sumOverNeighbors<Vec4f>(i, neighbors, difference, positions, velocities);
}

struct SmoothVelocity {
  NeighborView neighbors;
  SpikyKernel kernel;
  float weight;  // c·V0
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<Vec3f> smoothed;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto v = read(velocities, i);
    const auto sum = weightedDifferences(i, neighbors, kernel, v, positions, velocities);
    write(smoothed, i, v + weight * xyz(sum));
  }
};

/// The same from codes of the motion, on CUDA.
struct SmoothCodedVelocity {
  NeighborView neighbors;
  SpikyKernel kernel;
  float weight;  // c·V0
  float unit;    // m, of decoded coordinates
  ArrayView<const Vec4f> codes;
  ArrayView<const Vec3f> velocities;
  ArrayView<Vec3f> smoothed;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const Vec3f v = read(velocities, i);
    const MotionCode::Sight sight(read(codes, i));
    const auto difference = [&](int, const Vec4f& code) {
      const MotionCode::Other other = sight(code);
      const float w = kernel.value(unit * fastSqrt(dot(other.away, other.away)));
      return Vec4f{w * other.faster.x, w * other.faster.y, w * other.faster.z, 0};
    };
    write(smoothed, i, v + weight * xyz(sumOverNeighbors<Vec4f>(i, neighbors, difference, codes)));
  }
};

/// One Jacobi sweep.
struct ApproachMean {
  NeighborView neighbors;
  SpikyKernel kernel;
  float share;  // b/(1 + b)
  ArrayView<const Vec3f> positions, initial, present;
  ArrayView<Vec3f> next;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto v = read(initial, i);
    const auto sum = weightedDifferences(i, neighbors, kernel, v, positions, present);
    const auto weight = keptWhere(sum.w > 0, share / sum.w);
    write(next, i, v + weight * xyz(sum));
  }
};

}  // namespace

template <class Backend>
void Xsph::stepOn(Backend& device, FluidStep& fluid) {
  const ArrayView<const Vec4f> codes = fluid.particles.motionCodes();
  Array<Vec3f>& smoothed = fluid.particles.scratch();
  const FluidConstants& c = fluid.constants;
  const Count count = fluid.particles.count();
  const float weight = strength * c.particleVolume;
  const ArrayView<const Vec3f> velocities = fluid.particles.velocities().view();
  bool done = false;
  if constexpr (std::is_same_v<Backend, CudaDevice>) {
    done = codes.size > 0;
    if (done)
      parallelForSums(
          device, "smooth", count,
          SmoothCodedVelocity{fluid.neighbors.view(), c.kernel, weight,
                              MotionCode::Sight::unit(c.supportRadius), codes, velocities, smoothed.view()});
  }
  if (!done)
    parallelForSums(device, "smooth", count,
                    SmoothVelocity{fluid.neighbors.view(), c.kernel, weight,
                                   fluid.particles.positions().view(), velocities, smoothed.view()});
  // Equal sizes; only the memory changes hands.
  smoothed.swap(fluid.particles.velocities());
}

template <class Backend>
void Xsph::implicitOn(Backend& device, FluidStep& fluid) {
  constexpr int kSweeps = 3;
  fitScratch(fluid, next_);
  Array<Vec3f>& smoothed = fluid.particles.scratch();
  const FluidConstants& c = fluid.constants;
  const float b = static_cast<float>(fluid.time.dt) * viscosity / c.supportRadius;
  // Of infinite b, too.
  const float share = 1 / (1 + 1 / b);
  Array<Vec3f>& velocities = fluid.particles.velocities();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const Array<Vec3f>& present = sweep == 0 ? velocities : smoothed;
    parallelForSums(device, "approach mean", fluid.particles.count(),
                    ApproachMean{fluid.neighbors.view(), c.kernel, share, fluid.particles.positions().view(),
                                 velocities.view(), present.view(), next_.view()});
    next_.swap(smoothed);
  }
  smoothed.swap(velocities);
}

template void Xsph::stepOn(ThisBackend&, FluidStep&);
template void Xsph::implicitOn(ThisBackend&, FluidStep&);

}  // namespace weir
