// The operator of TwoProjections (two_projections.h), its adjoint, and conjugate gradients with them.
#pragma once

#include "framework/compute/parallel.h"
#include "nodes/particle_fluid/modules/projection_packing.h"
#include "nodes/particle_fluid/modules/projection_sums.h"
#include "nodes/particle_fluid/modules/projection_walls.h"

namespace weir::projection {

/// Rows of L.
struct FindGradients {
  ProjectionPacking packing;
  WallPlanes planes;
  ArrayView<const Vec3f> u;
  ArrayView<Vec3f> rowX, rowY, rowZ;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f own = u[i];
    Vec3f x{}, y{}, z{};
    Vec3f all{};
    packing.forEach(i, [&](int j, const Vec3f& g, const Vec3f&) {
      all += g;
      const Vec3f change = u[j] - own;
      x += change.x * g;
      y += change.y * g;
      z += change.z * g;
    });
    planes.at(i, xyz(packing.state[i]), all).forEach([&](const WallPlane& of) {
      const Vec3f along = of.push * dot(of.normal, own - of.velocity) * of.normal;
      x += along.x * of.normal;
      y += along.y * of.normal;
      z += along.z * of.normal;
    });
    const SymmetricTensor n = packing.tensor(i);
    rowX[i] = n * x;
    rowY[i] = n * y;
    rowZ[i] = n * z;
  }
};

struct Smooth {
  ProjectionPacking packing;
  float share;
  ArrayView<const Vec3f> u, rowX, rowY, rowZ;
  ArrayView<Vec3f> smoothed;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f own = u[i], x = rowX[i], y = rowY[i], z = rowZ[i];
    const float weight = share * packing.gradient.particleVolume;
    Vec3f sum{};
    packing.forEach(i, [&](int j, const Vec3f&, const Vec3f& r) {
      const Vec3f linear{dot(x + rowX[j], r), dot(y + rowY[j], r), dot(z + rowZ[j], r)};
      sum += (weight * packing.gradient.kernel.value(sqrtf(dot(r, r)))) * (u[j] - own - 0.5f * linear);
    });
    smoothed[i] = own + sum;
  }
};

/// D·u.
struct Divergence {
  ProjectionPacking packing;
  ArrayView<const Vec3f> u;
  ArrayView<float> divergence;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f own = u[i];
    const SymmetricTensor n = packing.tensor(i);
    float sum = dot(packing.wall[i], own);
    packing.forEach(i, [&](int j, const Vec3f& g, const Vec3f&) { sum += dot(u[j] - own, n * g); });
    divergence[i] = sum;
  }
};

/// Dᵀp.
struct PushOf {
  ProjectionPacking packing;
  ArrayView<const float> p;
  ArrayView<Vec3f> push;

  WEIR_HD void operator()(std::int64_t i) const {
    Vec3f all{}, others{};
    packing.forEach(i, [&](int j, const Vec3f& g, const Vec3f&) {
      all += g;
      if (const float q = p[j]; q != 0) others += q * (packing.tensor(j) * g);
    });
    push[i] = p[i] * (packing.wall[i] - packing.tensor(i) * all) - others;
  }
};

/// The diagonal of D·Dᵀ, inverse.
struct FindPreconditioner {
  ProjectionPacking packing;
  ArrayView<float> preconditioner;

  WEIR_HD void operator()(std::int64_t i) const {
    const SymmetricTensor n = packing.tensor(i);
    Vec3f all{};
    float squares = 0;
    packing.forEach(i, [&](int, const Vec3f& g, const Vec3f&) {
      const Vec3f e = n * g;
      all += e;
      squares += dot(e, e);
    });
    const Vec3f own = packing.wall[i] - all;
    preconditioner[i] =
        1 / (squares + dot(own, own) +
             1e-6f * packing.gradient.kernel.inverseRadius * packing.gradient.kernel.inverseRadius);
  }
};

/// What is left of −D·v − s by the pressures that there are, where they may act.
struct Start {
  ArrayView<const float> source, product, room, q, preconditioner;
  ArrayView<float> residual, direction;

  WEIR_HD void operator()(std::int64_t i) const {
    const float left = -source[i] - room[i] - product[i];
    const bool acts = q[i] > 0 || left > 0;
    residual[i] = acts ? left : 0.0f;
    direction[i] = acts ? preconditioner[i] * left : 0.0f;
  }
};

/// Particles without a direction are left as they are: their residual is 0 as long as a round takes.
struct SumTerms {
  ArrayView<const float> residual, direction, product, preconditioner;
  WEIR_HD ProjectionSums operator()(std::int64_t i) const {
    const double r = residual[i];
    return {double(direction[i]) * double(product[i]), r * double(preconditioner[i]) * r, r * r};
  }
};
/// Whether an iteration goes on, given the sums before it.
WEIR_HD inline bool goesOn(const ProjectionSums& before, double enough) {
  return before.squares > enough && before.curvature > 0;
}

/// How many particles the passes have: all, or none once a round is done, so that the device runs several
/// iterations before the host looks at them.
struct Judge {
  Count count;
  double enough;
  const ProjectionSums* before;  ///< null: all
  int* active;

  WEIR_HD void operator()(std::int64_t) const {
    *active = before == nullptr || goesOn(*before, enough) ? static_cast<int>(count.get()) : 0;
  }
};

struct Advance {
  const ProjectionSums* before;
  ArrayView<const float> direction, product;
  ArrayView<float> q, residual;

  WEIR_HD void operator()(std::int64_t i) const {
    const float length = float(before->descent / before->curvature);
    q[i] += length * direction[i];
    if (direction[i] != 0) residual[i] -= length * product[i];
  }
};

struct Turn {
  const ProjectionSums *before, *after;
  ArrayView<const float> residual, preconditioner;
  ArrayView<float> direction;

  WEIR_HD void operator()(std::int64_t i) const {
    const float share = float(after->descent / before->descent);
    if (direction[i] != 0) direction[i] = preconditioner[i] * residual[i] + share * direction[i];
  }
};

struct Clamp {
  ArrayView<float> q;
  WEIR_HD void operator()(std::int64_t i) const {
    if (q[i] < 0) q[i] = 0;
  }
};

}  // namespace weir::projection
