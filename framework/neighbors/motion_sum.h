// Sums over how neighbours move beside a particle: over their distances and relative velocities.
#pragma once

#include "framework/neighbors/motion_code.h"
#include "framework/neighbors/neighbor_sum.h"
#include "framework/particles/particle_set.h"

namespace weir {

/// Positions and velocities as they are.
struct ExactMotion {
  ArrayView<const Vec3f> positions, velocities;
};

/// The same from codes of 16 bytes a particle (motion_code.h), which CUDA gathers in one access.
struct CodedMotion {
  ArrayView<const Vec4f> codes;
  ArrayView<const Vec3f> velocities;
  float unit;  // m, of decoded coordinates
};

/// Σ f(r_ij, v_j − v) over the neighbours j of i, for a velocity v of i. f is a generic lambda, as in
/// sumOverNeighbors, that returns four numbers.
template <class Index, class Velocity, class F>
WEIR_HD Vec4<NumberAt<Index>> sumOverMotion(Index i, const NeighborView& neighbors, const ExactMotion& motion,
                                            const Velocity& v, const F& f) {
  const auto p = read(motion.positions, i);
  const auto pair = [&]<class T>(const auto&, const Vec3<T>& q, const Vec3<T>& u) {
    const Vec3<T> d{q.x - p.x, q.y - p.y, q.z - p.z};
    return f(fastSqrt(dot(d, d)), Vec3<T>{u.x - v.x, u.y - v.y, u.z - v.z});
  };
  return sumOverNeighbors<Vec4f>(i, neighbors, pair, motion.positions, motion.velocities);
}

/// v stands in the particle's own code.
template <class Index, class Velocity, class F>
WEIR_HD Vec4f sumOverMotion(Index i, const NeighborView& neighbors, const CodedMotion& motion,
                            const Velocity& /*v*/, const F& f) {
  const MotionCode::Sight sight(read(motion.codes, i));
  const auto pair = [&](int, const Vec4f& code) {
    const MotionCode::Other other = sight(code);
    return f(motion.unit * fastSqrt(dot(other.away, other.away)), other.faster);
  };
  return sumOverNeighbors<Vec4f>(i, neighbors, pair, motion.codes);
}

/// Calls f(motion) with the motion of the particles as the device reads it fastest.
template <class Backend, class F>
void withMotion([[maybe_unused]] Backend& device, const ParticleSet& particles,
                [[maybe_unused]] float supportRadius, const F& f) {
  const ArrayView<const Vec3f> velocities = particles.velocities().read();
  if constexpr (std::is_same_v<Backend, CudaDevice>) {
    const ArrayView<const Vec4f> codes = particles.byProducts().find(kMotionCodes);
    if (codes.size > 0) return f(CodedMotion{codes, velocities, MotionCode::Sight::unit(supportRadius)});
  }
  f(ExactMotion{particles.positions().read(), velocities});
}

}  // namespace weir
