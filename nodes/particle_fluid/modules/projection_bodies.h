// Bodies in the projection of TwoProjections (two_projections.h): six more unknowns each, strongly coupled.
//
// To D_i of particle i a body m with the velocities V_m adds −w_im·J_im·V_m, w_im = Σ k·(n·N·n)·n being the
// sum over its planes and J_im·V_m the velocity of its point at the particle's predicted position. The least
// change of the kinetic energy ½m·Σ|v − v*|² + ½(V − V*)ᵀM(V − V*) that satisfies D·v ≥ −s is
//
//   v = v* + Dᵀq,   V_m = V_m* − m·M⁻¹·Σ_i q_i·J_imᵀ·w_im
//
// so the operator of the conjugate gradients gains m·w_im·J_im·M⁻¹·Σ_j J_jmᵀ·w_jm·q_j, which is symmetric and
// not negative: bodies of any mass are stable. What a body gets is what its planes took from the particles.
#pragma once

#include "nodes/particle_fluid/body_coupling.h"

namespace weir::projection {

struct BodiesAtParticles {
  ArrayView<const SolidView> solids;
  SolidPairsView pairs;
  ArrayView<const int> near;
  ArrayView<const Vec3f> predicted;
  ArrayView<const Vec4f> wallOfPair;  ///< of each pair w, and what its wall carries, as q
  double particleMass;

  /// f(k, body, w, arm, pair) of each body k that particle i pushes.
  template <class F>
  WEIR_HD void forEach(int i, const F& f) const {
    forAll(i, [&](int k, const FreeBody& body, const Vec3d& w, const Vec3d& arm, int pair) {
      if (dot(w, w) > 0) f(k, body, w, arm, pair);
    });
  }
  /// The same of all that are near.
  template <class F>
  WEIR_HD void forAll(int i, const F& f) const {
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const int k = pairs.solid[pair];
      if (const FreeBody* body = solids[k].body)
        f(k, *body, doubleOf(xyz(wallOfPair[pair])), doubleOf(predicted[i]) - body->predicted.center, pair);
    }
  }
};

/// Σ q·Jᵀ·w of each body.
struct SumWrenches {
  BodiesAtParticles bodies;
  ArrayView<const float> q;

  template <class Give>
  WEIR_HD void operator()(std::int64_t n, const Give& give) const {
    const int i = bodies.near[n];
    const double push = q[i];
    if (push == 0) return;
    bodies.forEach(i, [&](int k, const FreeBody&, const Vec3d& w, const Vec3d& arm, int) {
      give(k, [&] { return push * Twist{w, cross(arm, w)}; });
    });
  }
};

/// The same of what walls carry.
struct SumCarried {
  BodiesAtParticles bodies;

  template <class Give>
  WEIR_HD void operator()(std::int64_t n, const Give& give) const {
    bodies.forEach(bodies.near[n], [&](int k, const FreeBody&, const Vec3d& w, const Vec3d& arm, int pair) {
      give(k, [&] { return double(bodies.wallOfPair[pair].w) * Twist{w, cross(arm, w)}; });
    });
  }
};

/// What these change of the bodies' velocities.
struct ChangeBodies {
  ArrayView<const SolidView> solids;
  const Twist* wrenches;
  double particleMass;

  WEIR_HD void operator()(std::int64_t k) const {
    FreeBody* body = solids[k].body;
    if (body == nullptr) return;
    body->change =
        solved(body->mass.matrix(body->predicted.rotation), -particleMass * wrenches[k], body->mass.locked);
  }
};

/// Adds what these changes are in D.
struct AddBodies {
  BodiesAtParticles bodies;
  ArrayView<float> divergence;

  WEIR_HD void operator()(std::int64_t n) const {
    const int i = bodies.near[n];
    double sum = 0;
    bodies.forEach(i, [&](int, const FreeBody& body, const Vec3d& w, const Vec3d& arm, int) {
      sum += dot(w, body.change.at(arm));
    });
    divergence[i] -= float(sum);
  }
};

/// What bodies add to the diagonal of the operator.
struct PreconditionBodies {
  BodiesAtParticles bodies;
  ArrayView<float> preconditioner;

  WEIR_HD void operator()(std::int64_t n) const {
    const int i = bodies.near[n];
    double sum = 0;
    bodies.forEach(i, [&](int, const FreeBody& body, const Vec3d& w, const Vec3d& arm, int) {
      const Twist push = bodies.particleMass * Twist{w, cross(arm, w)};
      const TwistMatrix mass = body.mass.matrix(body.predicted.rotation);
      sum += dot(w, solved(mass, push, body.mass.locked).at(arm));
    });
    preconditioner[i] = float(1 / (1 / double(preconditioner[i]) + sum));
  }
};

/// Bodies go where these changes lead.
struct DisplaceBodies {
  ArrayView<const SolidView> solids;
  double dt;

  WEIR_HD void operator()(std::int64_t k) const {
    if (FreeBody* body = solids[k].body) body->displacement += dt * body->change;
  }
};

/// Φ of particles at bodies follows these. What is told of pressure (SolidContact) is share·∇Φ of each solid:
/// here it is made the displacement that the body gave, to rounding.
struct TellOfBodies {
  BodiesAtParticles bodies;
  float dt;
  ArrayView<const float> q;
  ArrayView<float> lift, share;
  ArrayView<Vec4f> each;

  WEIR_HD void operator()(std::int64_t n) const {
    const int i = bodies.near[n];
    double lifted = 0, steep = 0, push = 0;
    bodies.forAll(i, [&](int, const FreeBody& body, const Vec3d& w, const Vec3d& arm, int pair) {
      const Vec3d gradient = doubleOf(xyz(each[pair]));
      lifted += dot(gradient, body.displacement.at(arm));
      steep += length(gradient);
      push += length(given(i, w, pair));
    });
    lift[i] = float(lifted);
    share[i] = steep > 0 ? float(-push / steep) : 0.0f;
    if (share[i] == 0) return;
    bodies.forAll(i, [&](int, const FreeBody&, const Vec3d& w, const Vec3d&, int pair) {
      const Vec3f to = floatOf(1 / double(share[i]) * given(i, w, pair));
      each[pair] = {to.x, to.y, to.z, each[pair].w};
    });
  }

 private:
  WEIR_HD Vec3d given(int i, const Vec3d& w, int pair) const {
    return double(dt) * (double(q[i]) + double(bodies.wallOfPair[pair].w)) * w;
  }
};

}  // namespace weir::projection
