// What a fluid particle at p feels of a solid that is a closed triangle mesh: integrals of the spiky kernel W
// (spiky_kernel.h) over the part S of the solid within the support radius H of p,
//
//   Φ = ∫_S W dV        ∇Φ, the gradient with respect to p        D = ∫_S |W'|/r dV
//
// From volume to surface. Lengths are in units of H from here on, s = 1, and p is the origin. Let f(r) be W
// or |W'|/r, and G(r) = ∫_r^1 f(z) z² dz. The field −G(r)/r²·r̂ has divergence f, except for −4π·G(0)·δ³ at
// the origin, and vanishes for r ≥ 1. With n towards the fluid and the plane of a triangle T at the signed
// distance δ = −y·n of p, the divergence theorem says
//
//   ∫_S f dV = Σ_T δ·∫_T G(r)/r³ dA + 4π·G(0)·[p inside]          (1)
//
// and likewise, because ∇_p W = −∇_y W,
//
//   ∇Φ = −Σ_T n·∫_T W dA.                                         (2)
//
// From surface to edges. In polar coordinates (ρ, θ) of the plane about the foot of p, dA = ρ dρ dθ = r dr
// dθ. A triangle is the signed sum over its edges of the fans between the foot and the edge. An edge at the
// distance |l| from the foot has points x along it, dθ = |l| dx/(l² + x²), R² = δ² + l² + x². So both need ∫
// (A(min(R, 1)) − A(|δ|)) dθ of an antiderivative A. Where R > 1, A(1) − A(|δ|) is constant: ∫dθ is an angle,
// and 2π times the constant is the integral of a half-space:
//
//   W:       Φ = ½·(1−q)⁵·(1+2q)         |W'|/r: D = 15/2·(1−q)⁴       q = |δ|     (3)
//   area:    ∫ W dA = 3/2·(1−q)⁴·(1+4q)
//
// Where R < 1, split G(r) = G(0) − g(r). The part of G(0) gives the solid angle of the fan, in closed form:
//
//   G(0)·sgn(δl)·[ atan(x/|l|) − atan(x|δ|/(|l|R)) ]                              (4)
//   G(0) = 1/(4π) for W and 15/(4π) for |W'|/r.
//
// The rest has the polynomial antiderivatives A = ∫ g/r² dr, respectively ∫ W r dr for (2),
//
//   W:       15/π·(r²/6 − r³/4 + 3r⁴/20 − r⁵/30)
//   |W'|/r:  45/π·(r/2 − r²/3 + r³/12)                                            (5)
//   area:    15/π·(r²/2 − r³ + 3r⁴/4 − r⁵/5)
//
// and since l² + x² = R² − δ², its fan is l·∫ (A(R) − A(|δ|))/(R² − δ²) dx: the division is carried out by
// hand (it leaves no cancellation and no singularity, also at δ = l = 0) and Gauss-Legendre points along the
// edge do.
//
// Thin parts. A solid thinner than the support has its back within reach, and (1) counts only what matter
// there is: next to nothing, as if the fluid could lean on what is behind. Where fluid is not felt through a
// solid, all that a thin part hides must count as solid, as it does for a sheet. The sum over the triangles
// that face p (δ > 0) is just that: the integral over all that the surface hides from p. At a thick solid
// nothing faces away within reach and both are the same. At an edge they differ: what is round the corner
// is hidden, but it is not a wall that fluid leans on. So a back is left out as far as it is parallel to what
// faces p. With φ_T = δ·∫_T G(r)/r³ dA and the normal m of the back, its share is left out that is the mean
// of −n·m over what faces p, weighted by −n·m and φ_T:
//
//   min(1, |δ|/δ0)·Σ φ_T·(n·m)² / Σ −φ_T·n·m,   at most 1, and 0 if the divisor is not positive;  δ_T > 0 (6)
//
// which is 1 for the back of a plate, whatever else is near, and 0 for the side of a block. The first factor
// keeps it continuous where p moves over the plane of the back. A line of sight that enters solids twice
// counts both; Φ is bounded.
//
// Triangles that are small or thin, seen from p, need no edges: Gauss-Legendre points inside them do for (1)
// and (2), with an error far below the tolerance with which integrals() tells the sides of p apart.
//
// How ∇Φ changes with p, as far as that is due to the distance of p from planes: a plane's area (3) has the
// slope −f(δ)·∫ W dA,
//
//   ∇∇Φ ≈ Σ_T f(δ)·n⊗n·∫_T W dA,      f(q) = 20·q/((1−q)·(1+4q))          (7)
//
// over what faces p. Exact for planes; in the edge of a container what is left out is the change of what the
// one face shows while p moves along it. It is never negative, so what is extrapolated by it is convex.
//
// On the surface. (4) depends on the direction in which p lies from an edge, however near, and two triangles
// that disagree about that direction are wrong by up to 2π. Hence every edge computes δ and l from its own
// vector to the nearest point of its line, bit for bit the same one for both its triangles, so that rounding
// only moves the edge. A corner or a line that p touches is moved aside by a hair, again the same for all its
// triangles. What remains open is on which side of a face p lies; it changes the sum (1) for Φ by whole
// numbers only, see integrals(). So Φ, D and ∇Φ are finite and continuous on faces, edges and corners.
#pragma once

#include <cmath>
#include <type_traits>

#include "framework/base/api.h"
#include "framework/base/host_device.h"
#include "framework/base/symmetric_tensor.h"
#include "framework/base/vec.h"
#include "framework/solids/triangle_integrals.h"

namespace WEIR_API weir {

template <class T>
struct SolidIntegrals {
  T phi{};            ///< Φ, a fraction of the kernel's volume: 0 away from solids, s deep within one
  Vec3<T> gradPhi{};  ///< ∇Φ with respect to p, 1/m; points into the solid
  T d{};              ///< D, 1/m²; 15·s/H² deep within a solid

  WEIR_HD SolidIntegrals& operator+=(const SolidIntegrals& other) {
    gradPhi += other.gradPhi;
    phi += other.phi;
    d += other.d;
    return *this;
  }
};

/// Collects the triangles of a solid near one particle. All triangles with a point within H of p must be
/// added, others may be. The surface must be closed within the support, and must not cross itself: solids
/// that may overlap each take an integrator of their own, and their integrals are added.
template <class T>
class SolidIntegrator {
 public:
  /// p and all corners in m, in one frame; H > 0 is the support radius.
  WEIR_HD SolidIntegrator(const Vec3<T>& p, T supportRadius, bool isSheet = false)
      : inverseRadius_(T(1) / supportRadius), isSheet_(isSheet), triangles_(p, inverseRadius_) {}

  /// The triangle a, b, c, counter-clockwise seen from the fluid. Does nothing for triangles out of reach or
  /// without area.
  WEIR_HD void addTriangle(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
    Triangle triangle;
    if (triangles_.prepare(a, b, c, triangle)) add(termsOf(triangle));
  }
  WEIR_HD void add(const TriangleTerms<T>& triangle) {
    phi_ += triangle.phi;
    d_ += triangle.d;
    gradient_ -= triangle.normal * triangle.area;
    bend(triangle);
    if (triangle.delta > 0) face(triangle.normal, triangle.phi);
  }

  /// Whether p is not inside, see integrals().
  WEIR_HD bool isOutside() const { return turns(false) >= 0; }

  /// Counts what thin parts of a solid hide as solid too, see (6). For p outside, after all triangles were
  /// added: once for each of them.
  WEIR_HD void fillBehind(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
    Triangle triangle;
    if (triangles_.prepare(a, b, c, triangle) && partBehind(triangle.normal, triangle.delta) > 0)
      fillBehind(termsOf(triangle));
  }
  WEIR_HD void fillBehind(const TriangleTerms<T>& triangle) {
    const T part = partBehind(triangle.normal, triangle.delta);
    if (!(part > 0)) return;
    behindPhi_ -= triangle.phi * part;
    behindGradient_ += triangle.normal * (triangle.area * part);
    behindD_ -= triangle.d * part;
  }

  /// Sums what the threads of a team have added for the same particle; all of them then have all of it.
  template <class Team>
  WEIR_HD void unite(const Team& team) {
    uniteVector(team, gradient_), uniteVector(team, bend_.diagonal), uniteVector(team, bend_.off);
    phi_ = team.sum(phi_), d_ = team.sum(d_);
    for (Vec3<T>* v : {&facing_, &facingX_, &facingY_, &facingZ_}) uniteVector(team, *v);
  }

  /// The same of what was filled behind.
  template <class Team>
  WEIR_HD void uniteBehind(const Team& team) {
    uniteVector(team, behindGradient_), behindPhi_ = team.sum(behindPhi_), behindD_ = team.sum(behindD_);
  }

  /// The same by the approximation of Chang et al. 2020, "Semi-analytical solid boundary conditions for free
  /// surface flows", for comparison: the solid behind a triangle is taken to fill the whole cone from p
  /// through it, from the distance of its plane on, so that each integral is the solid angle times a radial
  /// tail. Too large by (1 + 4q + 10q²)/((1−q)(1+2q)) for Φ of a half-space. Do not mix with addTriangle.
  WEIR_HD void addTriangleApproximately(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
    using Edge = typename TriangleIntegrator<T>::Edge;
    Triangle triangle;
    if (!triangles_.prepare(a, b, c, triangle)) return;
    T solidAngle = 0;
    Vec3<T> direction;  // ∫ r̂ dΩ over the cone: minus its flat sides, as a closed surface has no net area
    for (int k = 0; k < 3; ++k) {
      const Vec3<T> u = triangle.corner[k], v = triangle.corner[(k + 1) % 3], side = cross(u, v);
      const Edge edge = triangles_.makeEdge(u, v, triangle.normal);
      solidAngle += triangles_.fanAngle(edge, edge.x1, triangle.side) -
                    triangles_.fanAngle(edge, edge.x0, triangle.side);
      direction -= normalized(side) * (T(0.5) * std::atan2(length(side), dot(u, v)));
    }
    const T q = std::abs(triangle.delta), t = 1 - q;
    phi_ += solidAngle * (t * t * t * t * (1 + 4 * q + 10 * q * q) / (4 * kPi));
    d_ += solidAngle * (t * t * t * (1 + 3 * q) * 15 / (4 * kPi));
    gradient_ += direction * (t * t * t * (1 + 3 * q + 6 * q * q) * 3 / (2 * kPi));
  }

  /// The integrals, for the kernel's calibration s.
  ///
  /// Whether p is inside follows from the triangles themselves: without the last term of (1), Φ is in (0, 1)
  /// outside of a closed mesh and in (−1, 0) inside, so the term is whatever brings Φ to [0, 1]. The near
  /// triangles suffice, since all others contribute nothing. The sign cannot be told where next to nothing,
  /// or next to all, of the support is solid (Φ within kSideTolerance of 0 or 1); there insideWhenFar
  /// decides. The default says that a fluid particle far from all surfaces is in the fluid.
  WEIR_HD SolidIntegrals<T> integrals(T calibration, bool insideWhenFar = false) const {
    const T whole = turns(insideWhenFar);
    return scaled(phi_ - whole + behindPhi_, gradient_ + behindGradient_, d_ - whole * 15 + behindD_,
                  calibration);
  }

  /// The integrals over what a sheet hides from p: a surface without an inside, open or closed, that may be
  /// seen from either side. What lies behind it counts as solid, as far as straight lines from p meet it, so
  /// a closed sheet is a container for what is inside and a solid for what is outside. Added from triangles
  /// that are turned alike; which way does not matter, since the sign of the sum (1) says which side p is on.
  WEIR_HD SolidIntegrals<T> integralsOfSheet(T calibration) const {
    const T side = phi_ < 0 ? T(-1) : T(1);
    return scaled(side * phi_, gradient_ * side, side * d_, calibration);
  }

  /// (7), 1/m², for the kernel's calibration s; nothing of triangles that were added approximately.
  WEIR_HD SymmetricTensorOf<T> curvature(T calibration) const {
    const T scale = calibration * (inverseRadius_ * inverseRadius_);
    return {scale * bend_.diagonal, scale * bend_.off};
  }

  /// Well above the rounding of a sum over some hundred triangles.
  static constexpr T kSideTolerance = std::is_same_v<T, float> ? T(2e-5) : T(1e-9);

 private:
  using Triangle = typename TriangleIntegrator<T>::Triangle;

  static constexpr T kPi = TriangleIntegrator<T>::kPi;
  static constexpr T kMinCosine = T(1e-4);
  /// δ0 of (6), in H.
  static constexpr T kBackDepth = T(0.1);

  WEIR_HD SolidIntegrals<T> scaled(T phi, const Vec3<T>& gradient, T d, T calibration) const {
    // Rounding may leave the bounds by a little.
    const T boundedPhi = phi < 0 ? T(0) : (phi > 1 ? T(1) : phi),
            boundedD = d < 0 ? T(0) : (d > 15 ? T(15) : d);
    return {calibration * boundedPhi, gradient * (calibration * inverseRadius_),
            calibration * boundedD * (inverseRadius_ * inverseRadius_)};
  }

  /// The whole number to take from the sum (1) for Φ: −1 inside.
  WEIR_HD T turns(bool insideWhenFar) const {
    const T near = std::floor(phi_ + T(0.5));  // the whole number next to the sum
    if (std::abs(phi_ - near) < kSideTolerance) return insideWhenFar ? near - 1 : near;
    return std::floor(phi_);
  }

  WEIR_HD static TriangleTerms<T> termsOf(const Triangle& triangle) {
    using Of = TriangleIntegrator<T>;
    const T squaredDistance = Of::minSquaredDistance(triangle);
    if (!Of::isReached(squaredDistance)) return {T(0), T(0), T(0), triangle.normal, triangle.delta};
    const typename Of::Fine fine = Of::asFine(triangle, squaredDistance);
    return fine.is ? Of::termsOfFine(triangle, fine) : Of::termsOfEdges(triangle);
  }

  template <class Team>
  WEIR_HD static void uniteVector(const Team& team, Vec3<T>& v) {
    v = {team.sum(v.x), team.sum(v.y), team.sum(v.z)};
  }

  /// A sheet faces p with either side.
  WEIR_HD void bend(const TriangleTerms<T>& triangle) {
    const T q = isSheet_ && triangle.delta < 0 ? -triangle.delta : triangle.delta;
    if (!(q > 0) || !(q < 1)) return;
    bend_.addSquare(triangle.area * (20 * q / ((1 - q) * (1 + 4 * q))), triangle.normal);
  }

  WEIR_HD void face(const Vec3<T>& n, T phi) {
    facing_ -= n * phi;
    facingX_ += n * (phi * n.x), facingY_ += n * (phi * n.y), facingZ_ += n * (phi * n.z);
  }

  /// (6) without its first factor.
  WEIR_HD T parallelTo(const Vec3<T>& m) const {
    const T against = dot(facing_, m);
    const T squares = dot(m, Vec3<T>{dot(facingX_, m), dot(facingY_, m), dot(facingZ_, m)});
    // Less is rounding: of what is at right angles to all that faces p.
    const T min = kMinCosine * (facingX_.x + facingY_.y + facingZ_.z);
    return against > min ? (squares < against ? squares / against : T(1)) : T(0);
  }

  /// How much of a back is left out.
  WEIR_HD T partBehind(const Vec3<T>& normal, T delta) const {
    if (!(delta < 0)) return 0;
    const T depth = -delta / kBackDepth;
    return parallelTo(normal) * (depth < 1 ? depth : T(1));
  }

  T inverseRadius_;
  bool isSheet_;
  TriangleIntegrator<T> triangles_;
  // In units of H, for s = 1:
  T phi_ = 0;
  Vec3<T> gradient_;
  T d_ = 0;
  SymmetricTensorOf<T> bend_;  // (7)
  // (6): −Σ φ·n and the rows of Σ φ·n·nᵀ over what faces p; and what is to be added.
  Vec3<T> facing_, facingX_, facingY_, facingZ_;
  T behindPhi_ = 0;
  Vec3<T> behindGradient_;
  T behindD_ = 0;
};

}  // namespace weir
