#include "nodes/particle_fluid/modules/xsph.h"

#include "framework/neighbors/motion_sum.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/scratch.h"

namespace weir {

namespace {

/// v + c·V0·Σ_j W(r_ij)·(v_j − v).
template <class Motion>
struct SmoothVelocity {
  NeighborView neighbors;
  SpikyKernel kernel;
  float weight;  // c·V0
  Motion motion;
  ArrayView<Vec3f> smoothed;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto v = read(motion.velocities, i);
    const auto difference = [&]<class T>(const T& distance, const Vec3<T>& faster) {
      const T w = kernel.value(distance);
      return Vec4<T>{w * faster.x, w * faster.y, w * faster.z, w};
    };
    write(smoothed, i, v + weight * xyz(sumOverMotion(i, neighbors, motion, v, difference)));
  }
};

/// One Jacobi sweep of the implicit form, towards the mean over the neighbours.
struct ApproachMean {
  NeighborView neighbors;
  SpikyKernel kernel;
  float share;  // b/(1 + b)
  ArrayView<const Vec3f> positions, initial, present;
  ArrayView<Vec3f> next;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    const auto v = read(initial, i);
    const auto difference = [&]<class T>(const T& distance, const Vec3<T>& faster) {
      const T w = kernel.value(distance);
      return Vec4<T>{w * faster.x, w * faster.y, w * faster.z, w};
    };
    const auto sum = sumOverMotion(i, neighbors, ExactMotion{positions, present}, v, difference);
    const auto weight = zeroUnless(sum.w > 0, share / sum.w);
    write(next, i, v + weight * xyz(sum));
  }
};

}  // namespace

template <class Backend>
void Xsph::sweepOn(Backend& device, FluidStep& fluid, float share) {
  const FluidConstants& c = fluid.constants;
  const float weight = share * c.particleVolume;
  fluid.exchange({"position", "velocity"});
  const Lease<Vec3f> smoothed = fluid.particles.leaseVectors();
  withMotion(device, fluid.particles, c.supportRadius, [&]<class Motion>(const Motion& motion) {
    parallelForSums(device, "smooth", fluid.particles.count(),
                    SmoothVelocity<Motion>{fluid.neighbors.view(), c.kernel, weight, motion, smoothed.view()},
                    fluid.divided == nullptr);
  });
  fluid.particles.velocities().swap(smoothed);
}

template <class Backend>
void Xsph::implicitOn(Backend& device, FluidStep& fluid) {
  constexpr int kSweeps = 3;
  fluid.exchange({"position", "velocity"});
  fitScratch(fluid, next_);
  const Lease<Vec3f> smoothed = fluid.particles.leaseVectors();
  const FluidConstants& c = fluid.constants;
  const float b = static_cast<float>(fluid.time.dt) * viscosity / c.supportRadius;
  // Of infinite b, too.
  const float share = 1 / (1 + 1 / b);
  const Attribute<Vec3f> velocities = fluid.particles.velocities();
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const ArrayView<const Vec3f> initial = velocities.read(),
                                 present = sweep == 0 ? initial : smoothed.view();
    parallelForSums(device, "approach mean", fluid.particles.count(),
                    ApproachMean{fluid.neighbors.view(), c.kernel, share, fluid.particles.positions().read(),
                                 initial, present, next_.view()},
                    fluid.divided == nullptr);
    smoothed.swap(next_);
    if (sweep + 1 < kSweeps) fluid.exchange(smoothed.view());
  }
  velocities.swap(smoothed);
}

template void Xsph::sweepOn(ThisBackend&, FluidStep&, float);
template void Xsph::implicitOn(ThisBackend&, FluidStep&);

}  // namespace weir
