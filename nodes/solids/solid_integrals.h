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
// is hidden, but it is no wall that fluid leans on. So a back is left out as far as it is parallel to what
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
// On the surface. (4) depends on the direction in which p lies from an edge, however near, and two triangles
// that disagree about that direction are wrong by up to 2π. Hence every edge computes δ and l from its own
// vector to the nearest point of its line, bit for bit the same one for both its triangles, so that rounding
// only moves the edge. A corner or a line that p touches is moved aside by a hair, again the same for all its
// triangles. What remains open is on which side of a face p lies; it changes the sum (1) for Φ by whole
// numbers only, see integrals(). So Φ, D and ∇Φ are finite and continuous on faces, edges and corners.
#pragma once

#include <cmath>
#include <type_traits>

#include "framework/base/host_device.h"
#include "framework/base/vec.h"

namespace weir {

template <class T>
struct SolidIntegrals {
  T phi{};            ///< Φ, a fraction of the kernel's volume: 0 away from solids, s deep within one
  Vec3<T> gradPhi{};  ///< ∇Φ with respect to p, 1/m; points into the solid
  T d{};              ///< D, 1/m²; 15·s/H² deep within a solid
};

/// Collects the triangles of a solid near one particle. All triangles with a point within H of p must be
/// added, others may be. The surface must be closed within the support, and must not cross itself: solids
/// that may overlap each take an integrator of their own, and their integrals are added.
template <class T>
class SolidIntegrator {
 public:
  /// p and all corners in m, in one frame; H > 0 is the support radius.
  WEIR_HD SolidIntegrator(const Vec3<T>& p, T supportRadius) : p_(p), inverseRadius_(T(1) / supportRadius) {}

  /// The triangle a, b, c, counter-clockwise seen from the fluid. Does nothing for triangles out of reach or
  /// without area.
  WEIR_HD void addTriangle(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
    Triangle triangle;
    if (!prepare(a, b, c, triangle)) return;
    const T before = phi_;
    add(triangle);
    if (triangle.delta > 0) face(triangle.normal, phi_ - before);
  }

  /// Whether p is not inside, see integrals().
  WEIR_HD bool isOutside() const { return turns(false) >= 0; }

  /// Counts what thin parts of a solid hide as solid too, see (6). For p outside, after all triangles were
  /// added: once for each of them.
  WEIR_HD void fillBehind(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
    Triangle triangle;
    if (!prepare(a, b, c, triangle) || !(triangle.delta < 0)) return;
    const T depth = -triangle.delta / kBackDepth;
    const T part = parallelTo(triangle.normal) * (depth < 1 ? depth : T(1));
    if (!(part > 0)) return;
    SolidIntegrator back(p_, T(1));
    back.add(triangle);
    behindPhi_ -= back.phi_ * part;
    behindGradient_ -= back.gradient_ * part;
    behindD_ -= back.d_ * part;
  }

  /// Sums what the threads of a team have added for the same particle; all of them then have all of it.
  template <class Team>
  WEIR_HD void unite(const Team& team) {
    uniteVector(team, gradient_), phi_ = team.sum(phi_), d_ = team.sum(d_);
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
    Triangle triangle;
    if (!prepare(a, b, c, triangle)) return;
    T solidAngle = 0;
    Vec3<T> direction;  // ∫ r̂ dΩ over the cone: minus its flat sides, as a closed surface has no net area
    for (int k = 0; k < 3; ++k) {
      const Vec3<T> u = triangle.corner[k], v = triangle.corner[(k + 1) % 3], side = cross(u, v);
      const Edge edge = makeEdge(u, v, triangle.normal);
      solidAngle += fanAngle(edge, edge.x1, triangle.side) - fanAngle(edge, edge.x0, triangle.side);
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

  /// Well above the rounding of a sum over some hundred triangles.
  static constexpr T kSideTolerance = std::is_same_v<T, float> ? T(2e-5) : T(1e-9);

 private:
  static constexpr T kPi = T(3.14159265358979323846);
  /// How near p may come to a corner and to the line of an edge, in H.
  static constexpr T kCornerGap = std::is_same_v<T, float> ? T(1e-5) : T(1e-9);
  static constexpr T kLeastCosine = T(1e-4);
  /// δ0 of (6), in H.
  static constexpr T kBackDepth = T(0.1);
  static constexpr T kLineGap = kCornerGap * T(1e-4);

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

  struct Triangle {
    Vec3<T> corner[3];  // relative to p
    Vec3<T> normal;
    T delta;  // the distance of p in front of the plane
    T side;   // its sign
  };

  struct Edge {
    T x0, x1;    // its ends, along itself, from the point nearest to p on its line
    T from, to;  // the part of it within the support; empty if from ≥ to
    T l;      // the distance of its line from the foot of p, positive if the foot is on the triangle's side
    T delta;  // the distance of p in front of the plane
  };

  template <class Team>
  WEIR_HD static void uniteVector(const Team& team, Vec3<T>& v) {
    v = {team.sum(v.x), team.sum(v.y), team.sum(v.z)};
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
    const T least = kLeastCosine * (facingX_.x + facingY_.y + facingZ_.z);
    return against > least ? (squares < against ? squares / against : T(1)) : T(0);
  }

  /// An arbitrary direction that edges of meshes are not likely to have.
  WEIR_HD static Vec3<T> aside() { return {T(0.3523), T(0.8129), T(0.4637)}; }

  /// False if the triangle is certainly out of reach or has no area.
  WEIR_HD bool prepare(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c, Triangle& triangle) const {
    Vec3<T>* corner = triangle.corner;
    corner[0] = relative(a), corner[1] = relative(b), corner[2] = relative(c);
    const Vec3<T> lo = min(corner[0], min(corner[1], corner[2])),
                  hi = max(corner[0], max(corner[1], corner[2]));
    if (lo.x > 1 || lo.y > 1 || lo.z > 1 || hi.x < -1 || hi.y < -1 || hi.z < -1) return false;
    triangle.normal = normalized(cross(corner[1] - corner[0], corner[2] - corner[0]));
    // The nearest corner gives the least rounding.
    const T rr[3] = {dot(corner[0], corner[0]), dot(corner[1], corner[1]), dot(corner[2], corner[2])};
    const int nearest = rr[0] < rr[1] ? (rr[0] < rr[2] ? 0 : 2) : (rr[1] < rr[2] ? 1 : 2);
    triangle.delta = -dot(corner[nearest], triangle.normal);
    triangle.side = triangle.delta < 0 ? T(-1) : T(1);
    return std::abs(triangle.delta) < 1 && dot(triangle.normal, triangle.normal) > 0;
  }

  WEIR_HD void add(const Triangle& triangle) {
    const T squaredDistance = leastSquaredDistance(triangle);
    if (squaredDistance > T(1.001) || addFine(triangle, squaredDistance)) return;
    Edge edges[3];
    bool cut = false, around = true;
    for (int k = 0; k < 3; ++k) {
      edges[k] = makeEdge(triangle.corner[k], triangle.corner[(k + 1) % 3], triangle.normal);
      cut = cut || edges[k].from < edges[k].to;
      around = around && edges[k].l > 0;
    }
    if (cut) {
      for (const Edge& edge : edges) addFan(edge, triangle);
    } else if (around) {
      addOuter(triangle.side, T(2) * kPi, std::abs(triangle.delta), triangle.normal);
    }
  }

  /// A lower bound of the distance of a triangle, squared: that of its plane, and within the plane how far p
  /// is on the outer side of one of the edges.
  WEIR_HD static T leastSquaredDistance(const Triangle& triangle) {
    T out = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3<T>& u = triangle.corner[k];
      const Vec3<T> along = triangle.corner[(k + 1) % 3] - u;
      const T inwards = dot(cross(u, along), triangle.normal);
      if (!(inwards < 0)) continue;
      const T squared = inwards * inwards / dot(along, along);
      out = squared > out ? squared : out;
    }
    return triangle.delta * triangle.delta + out;
  }

  /// Adds a triangle by points inside it if it is so thin, seen from p, that they are accurate to 1e-5 or so
  /// in Φ; false if it is not.
  WEIR_HD bool addFine(const Triangle& triangle, T squaredDistance) {
    constexpr T kThin = T(0.4), kLong = 4;  // largest width and length, in distances from p
    const Vec3<T>* corner = triangle.corner;
    T squaredLength[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3<T> along = corner[(k + 1) % 3] - corner[k];
      squaredLength[k] = dot(along, along);
    }
    const int second = squaredLength[1] < squaredLength[2] ? 1 : 2;
    const int base = squaredLength[0] < squaredLength[second] ? 0 : second;  // the shortest edge
    if (squaredLength[base] > kThin * kThin * squaredDistance) return false;
    const T length = squaredLength[(base + 1) % 3];
    if ((length < 1 ? length : T(1)) > kLong * kLong * squaredDistance) return false;

    // y = apex + t·m for two points of Gauss-Legendre across the base, and dA = 2·area·t dt.
    const Vec3<T>&b = corner[base], &c = corner[(base + 1) % 3], &apex = corner[(base + 2) % 3];
    const Vec3<T> toBase = b - apex, across = c - b;
    const T area = weir::length(cross(toBase, across));
    constexpr T kFirst = T(0.211324865405187);  // (1 − 1/√3)/2
    addLine(triangle, apex, toBase + across * kFirst, area / 2);
    addLine(triangle, apex, toBase + across * (1 - kFirst), area / 2);
    return true;
  }

  /// Adds weight·∫ t·f(apex + t·m) dt over 0 ≤ t ≤ 1.
  WEIR_HD void addLine(const Triangle& triangle, const Vec3<T>& apex, const Vec3<T>& m, T weight) {
    const T mm = dot(m, m), foot = -dot(apex, m) / mm;
    const Vec3<T> nearest = apex + m * foot;
    const T squared = dot(nearest, nearest);
    if (!(squared < 1)) return;
    const T reach = std::sqrt((1 - squared) / mm);
    const T from = foot > reach ? foot - reach : T(0), to = foot + reach < 1 ? foot + reach : T(1);
    if (!(from < to)) return;
    // Like addInner: points are densest where f curves most.
    if (from < foot && foot < to) {
      addPart(triangle, {foot, squared, mm, from, foot, weight});
      addPart(triangle, {foot, squared, mm, foot, to, weight});
    } else {
      addPart(triangle, {foot, squared, mm, from, to, weight});
    }
  }

  struct LinePart {
    T foot, squared, mm;  // |y|² = squared + (t − foot)²·mm
    T from, to, weight;
  };

  WEIR_HD void addPart(const Triangle& triangle, const LinePart& line) {
    // Gauss-Legendre, eight points or, where f hardly curves, four.
    const T size = line.to - line.from;
    if (size * size * line.mm > line.squared) {
      const T node[8] = {T(-0.960289856497536), T(-0.796666477413627), T(-0.525532409916329),
                         T(-0.183434642495650), T(0.183434642495650),  T(0.525532409916329),
                         T(0.796666477413627),  T(0.960289856497536)};
      const T weight[8] = {T(0.101228536290376), T(0.222381034453374), T(0.313706645877887),
                           T(0.362683783378362), T(0.362683783378362), T(0.313706645877887),
                           T(0.222381034453374), T(0.101228536290376)};
      addPoints(triangle, line, node, weight);
    } else {
      const T node[4] = {T(-0.861136311594053), T(-0.339981043584856), T(0.339981043584856),
                         T(0.861136311594053)};
      const T weight[4] = {T(0.347854845137454), T(0.652145154862546), T(0.652145154862546),
                           T(0.347854845137454)};
      addPoints(triangle, line, node, weight);
    }
  }

  /// The integrands of (1) and (2) at points of a line; G has the closed forms (1−r)⁴·(1 + 4r + 10r²)/(4π)
  /// for W and (1−r)³·(1 + 3r)·15/(4π) for |W'|/r.
  template <int kPoints>
  WEIR_HD void addPoints(const Triangle& triangle, const LinePart& line, const T (&node)[kPoints],
                         const T (&weight)[kPoints]) {
    const T middle = (line.from + line.to) / 2, half = (line.to - line.from) / 2;
    T w[kPoints], d[kPoints], area[kPoints];  // apart from the sums, for vector units
    for (int k = 0; k < kPoints; ++k) {
      const T t = middle + half * node[k], x = t - line.foot;
      const T rr = line.squared + x * x * line.mm, r = std::sqrt(rr);
      const T s = r < 1 ? 1 - r : T(0), sss = s * s * s, share = weight[k] * t, overCube = share / (rr * r);
      w[k] = overCube * sss * s * (1 + 4 * r + 10 * rr);
      d[k] = overCube * sss * (1 + 3 * r);
      area[k] = share * sss;
    }
    T sumW = 0, sumD = 0, sumArea = 0;
    for (int k = 0; k < kPoints; ++k) sumW += w[k], sumD += d[k], sumArea += area[k];
    const T scale = line.weight * half / (4 * kPi);
    phi_ += triangle.delta * scale * sumW;
    d_ += triangle.delta * scale * 15 * sumD;
    gradient_ -= triangle.normal * (scale * 60 * sumArea);
  }

  WEIR_HD Vec3<T> relative(const Vec3<T>& corner) const {
    const Vec3<T> r = (corner - p_) * inverseRadius_;
    return dot(r, r) < kCornerGap * kCornerGap ? aside() * kCornerGap : r;
  }

  WEIR_HD static Edge makeEdge(const Vec3<T>& u, const Vec3<T>& v, const Vec3<T>& normal) {
    const Vec3<T> along = normalized(v - u);
    Edge edge;
    edge.x0 = dot(u, along), edge.x1 = dot(v, along);
    // From the nearer end, for its smaller rounding. Nothing here may depend on the direction of the edge.
    const Vec3<T> fromU = u - along * edge.x0, fromV = v - along * edge.x1;
    const T uu = dot(u, u), vv = dot(v, v);
    Vec3<T> foot = uu < vv ? fromU : vv < uu ? fromV : (fromU + fromV) * T(0.5);
    foot -= along * dot(foot, along);  // what rounding left along the edge may be all of a small vector
    if (dot(foot, foot) < kLineGap * kLineGap)
      foot = normalized(aside() - along * dot(aside(), along)) * kLineGap;
    edge.delta = -dot(foot, normal);
    edge.l = dot(foot, cross(along, normal));
    const T rest = 1 - edge.delta * edge.delta - edge.l * edge.l, half = rest > 0 ? std::sqrt(rest) : T(0);
    edge.from = edge.x0 > -half ? edge.x0 : -half;
    edge.to = edge.x1 < half ? edge.x1 : half;
    return edge;
  }

  /// Adds the fan between the foot of p and an edge.
  WEIR_HD void addFan(const Edge& edge, const Triangle& triangle) {
    const T sign = edge.l < 0 ? T(-1) : T(1);
    const T q = std::abs(edge.delta);
    if (!(edge.from < edge.to)) {
      addOuter(triangle.side, sign * angle(edge.l, edge.x0, edge.x1), q, triangle.normal);
      return;
    }
    T outer = 0;
    if (edge.x0 < edge.from) outer += angle(edge.l, edge.x0, edge.from);
    if (edge.to < edge.x1) outer += angle(edge.l, edge.to, edge.x1);
    if (outer > 0) addOuter(triangle.side, sign * outer, q, triangle.normal);

    const T solidAngle = fanAngle(edge, edge.to, triangle.side) - fanAngle(edge, edge.from, triangle.side);
    phi_ += solidAngle / (4 * kPi);
    d_ += solidAngle * 15 / (4 * kPi);
    // R has its greatest curvature at x = 0, so the points are densest there.
    if (edge.from < 0 && edge.to > 0) {
      addInner(edge, edge.from, 0, triangle.normal);
      addInner(edge, 0, edge.to, triangle.normal);
    } else {
      addInner(edge, edge.from, edge.to, triangle.normal);
    }
  }

  /// The constants (3) over the angle ∫dθ, signed by the edge; q = |δ|.
  WEIR_HD void addOuter(T side, T angle, T q, const Vec3<T>& normal) {
    const T t = q < 1 ? 1 - q : T(0), t4 = t * t * t * t, turns = angle / (2 * kPi);
    phi_ += side * turns * T(0.5) * t4 * t * (1 + 2 * q);
    d_ += side * turns * T(7.5) * t4;
    gradient_ -= normal * (turns * T(1.5) * t4 * (1 + 4 * q));
  }

  /// The antiderivatives (5) over the part [x0, x1] of the edge, all within the support.
  WEIR_HD void addInner(const Edge& edge, T x0, T x1, const Vec3<T>& normal) {
    // Gauss-Legendre on [-1, 1], five points.
    const T node[5] = {T(-0.906179845938664), T(-0.538469310105683), T(0), T(0.538469310105683),
                       T(0.906179845938664)};
    const T weight[5] = {T(0.236926885056189), T(0.478628670499366), T(0.568888888888889),
                         T(0.478628670499366), T(0.236926885056189)};
    const T q = std::abs(edge.delta), qq = q * q, rho = edge.l * edge.l + qq;
    const T middle = (x0 + x1) / 2, half = (x1 - x0) / 2;
    T w = 0, d = 0, area = 0;
    for (int k = 0; k < 5; ++k) {
      const T x = middle + half * node[k], r = std::sqrt(rho + x * x);
      // cₙ = (rⁿ − qⁿ)/(r² − q²)
      const T c1 = 1 / (r + q), c3 = r + qq * c1, c4 = r * r + qq, c5 = r * c4 + qq * qq * c1;
      w += weight[k] * (T(1) / 6 - c3 / 4 + c4 * 3 / 20 - c5 / 30);
      d += weight[k] * (c1 / 2 - T(1) / 3 + c3 / 12);
      area += weight[k] * (T(0.5) - c3 + c4 * 3 / 4 - c5 / 5);
    }
    const T scale = edge.l * half * 15 / kPi;
    phi_ -= edge.delta * scale * w;
    d_ -= edge.delta * scale * 3 * d;
    gradient_ -= normal * (scale * area);
  }

  /// The angle between the points xa ≤ xb of an edge, seen from the foot of p, in [0, π].
  WEIR_HD static T angle(T l, T xa, T xb) { return std::atan2(std::abs(l) * (xb - xa), l * l + xa * xb); }

  /// (4) for the part [0, x] of the edge. With the sign of the plane's side instead of |δ| it stays
  /// continuous if the edge's own δ has the other sign by rounding.
  WEIR_HD static T fanAngle(const Edge& edge, T x, T side) {
    const T l = std::abs(edge.l), delta = side * edge.delta;
    const T r = std::sqrt(delta * delta + l * l + x * x);
    const T fan = std::atan2(x * l * (r - delta), l * l * r + x * x * delta);
    return edge.l < 0 ? -side * fan : side * fan;
  }

  Vec3<T> p_;
  T inverseRadius_;
  // In units of H, for s = 1:
  T phi_ = 0;
  Vec3<T> gradient_;
  T d_ = 0;
  // (6): −Σ φ·n and the rows of Σ φ·n·nᵀ over what faces p; and what is to be added.
  Vec3<T> facing_, facingX_, facingY_, facingZ_;
  T behindPhi_ = 0;
  Vec3<T> behindGradient_;
  T behindD_ = 0;
};

}  // namespace weir
