// What one triangle of a solid contributes to the integrals of solid_integrals.h, where the equations stand
// that are numbered here. T is float, double, or Lanes for eight pairs of a particle and a triangle at a
// time.
//
// Lengths are in units of H, s = 1, and p is the origin.
#pragma once

#include <cmath>
#include <type_traits>

#include "framework/base/api.h"
#include "framework/base/vec.h"
#include "framework/compute/lanes.h"

namespace WEIR_API weir {

namespace detail {

template <class T>
struct RealOf {
  using Type = T;
};
#ifdef WEIR_HAS_LANES
template <>
struct RealOf<Lanes> {
  using Type = float;
};
#endif

/// What comparisons of T give.
template <class T>
using MaskOf = std::conditional_t<std::is_floating_point_v<T>, bool, decltype(T() < T())>;

}  // namespace detail

/// What the sums need of one triangle. The terms are zero where it is out of reach.
template <class T>
struct TriangleTerms {
  T phi{};         ///< of (1) for W
  T d{};           ///< of (1) for |W'|/r
  T area{};        ///< ∫ W dA of (2)
  Vec3<T> normal;  ///< towards the fluid
  T delta{};       ///< the distance of p in front of the plane
};

/// The triangles near one particle; with Lanes, near eight.
template <class T>
class TriangleIntegrator {
 public:
  using Real = typename detail::RealOf<T>::Type;
  using Mask = detail::MaskOf<T>;

  struct Triangle {
    Vec3<T> corner[3];  // relative to p
    Vec3<T> normal;     // towards the fluid
    T delta;            // the distance of p in front of the plane
    T side;             // its sign
  };

  /// p and all corners in m, in one frame; 1/H in 1/m.
  WEIR_HD TriangleIntegrator(const Vec3<T>& p, Real inverseRadius) : p_(p), inverseRadius_(inverseRadius) {}

  /// False if the triangle a, b, c, counter-clockwise seen from the fluid, is certainly out of reach or has
  /// no area.
  WEIR_HD Mask prepare(const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c, Triangle& triangle) const {
    Vec3<T>* corner = triangle.corner;
    corner[0] = relative(a), corner[1] = relative(b), corner[2] = relative(c);
    const Mask reachesX = isWithin(corner[0].x, corner[1].x, corner[2].x);
    const Mask reachesY = isWithin(corner[0].y, corner[1].y, corner[2].y);
    const Mask reachesZ = isWithin(corner[0].z, corner[1].z, corner[2].z);
    const Mask reaches = reachesX & reachesY & reachesZ;
    if (!any(reaches)) return reaches;
    triangle.normal = unit(cross(corner[1] - corner[0], corner[2] - corner[0]));
    // The nearest corner gives the least rounding.
    const T rr[3] = {dot(corner[0], corner[0]), dot(corner[1], corner[1]), dot(corner[2], corner[2])};
    const Mask first = rr[0] < rr[1];
    const Vec3<T> nearer = chosen(first, corner[0], corner[1]);
    const Vec3<T> nearest = chosen(select(first, rr[0], rr[1]) < rr[2], nearer, corner[2]);
    triangle.delta = -dot(nearest, triangle.normal);
    triangle.side = select(triangle.delta < T(0), T(-1), T(1));
    const Mask isNear = magnitude(triangle.delta)<T(1), hasArea = dot(triangle.normal, triangle.normal)> T(0);
    return reaches & isNear & hasArea;
  }

  /// A lower bound of the distance of a triangle, squared: that of its plane, and within the plane how far p
  /// is on the outer side of one of the edges.
  WEIR_HD static T minSquaredDistance(const Triangle& triangle) {
    T out = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3<T>& u = triangle.corner[k];
      const Vec3<T> along = triangle.corner[(k + 1) % 3] - u;
      const T inwards = dot(cross(u, along), triangle.normal);
      const Mask outside = inwards < T(0);
      if (!any(outside)) continue;
      const T squared = zeroUnless(outside, inwards * inwards / dot(along, along));
      out = select(squared > out, squared, out);
    }
    return triangle.delta * triangle.delta + out;
  }

  /// What is farther has no terms.
  WEIR_HD static Mask isReached(const T& squaredDistance) { return !(squaredDistance > T(Real(1.001))); }

  /// A triangle that is so thin, seen from p, that points inside it do.
  struct Fine {
    Mask is;
    Vec3<T> b, c, apex;  // b and c are the ends of the shortest edge
  };
  WEIR_HD static Fine asFine(const Triangle& triangle, const T& squaredDistance) {
    constexpr Real kThin = Real(0.4), kLong = 4;  // largest width and length, in distances from p
    const Vec3<T>* corner = triangle.corner;
    T squared[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3<T> along = corner[(k + 1) % 3] - corner[k];
      squared[k] = dot(along, along);
    }
    const Mask one = squared[1] < squared[2];
    const T second = select(one, squared[1], squared[2]);
    const Mask none = squared[0] < second;
    const T shortest = select(none, squared[0], second);
    const T next = select(none, squared[1], select(one, squared[2], squared[0]));
    const Mask fine = !((shortest > kThin * kThin * squaredDistance) |
                        (select(next < T(1), next, T(1)) > kLong * kLong * squaredDistance));
    return {fine, chosen(none, corner[0], chosen(one, corner[1], corner[2])),
            chosen(none, corner[1], chosen(one, corner[2], corner[0])),
            chosen(none, corner[2], chosen(one, corner[0], corner[1]))};
  }

  /// By points inside the triangle, accurate to 1e-5 or so in Φ.
  WEIR_HD static TriangleTerms<T> termsOfFine(const Triangle& triangle, const Fine& fine) {
    // y = apex + t·m for two points of Gauss-Legendre across the base, and dA = 2·area·t dt.
    const Vec3<T> toBase = fine.b - fine.apex, across = fine.c - fine.b;
    const Vec3<T> doubled = cross(toBase, across);
    const T weight = root(dot(doubled, doubled)) * Real(0.5);
    constexpr Real kFirst = Real(0.211324865405187);  // (1 − 1/√3)/2
    TriangleTerms<T> terms = noTerms(triangle);
    addLine(fine.apex, toBase + across * kFirst, weight, terms);
    addLine(fine.apex, toBase + across * (1 - kFirst), weight, terms);
    terms.phi *= triangle.delta;
    terms.d *= triangle.delta;
    return terms;
  }

  struct Edge {
    T x0, x1;    // its ends, along itself, from the point nearest to p on its line
    T from, to;  // the part of it within the support; empty if from ≥ to
    T l;      // the distance of its line from the foot of p, positive if the foot is on the triangle's side
    T delta;  // the distance of p in front of the plane
  };

  WEIR_HD static Edge makeEdge(const Vec3<T>& u, const Vec3<T>& v, const Vec3<T>& normal) {
    const Vec3<T> along = unit(v - u);
    Edge edge;
    edge.x0 = dot(u, along), edge.x1 = dot(v, along);
    // From the nearer end, for its smaller rounding. Nothing here may depend on the direction of the edge.
    const Vec3<T> fromU = u - along * edge.x0, fromV = v - along * edge.x1;
    const T uu = dot(u, u), vv = dot(v, v);
    Vec3<T> foot = chosen(uu < vv, fromU, chosen(vv < uu, fromV, (fromU + fromV) * T(Real(0.5))));
    foot -= along * dot(foot, along);  // what rounding left along the edge may be all of a small vector
    const Mask touches = dot(foot, foot) < T(kLineGap * kLineGap);
    if (any(touches)) foot = chosen(touches, unit(aside() - along * dot(aside(), along)) * kLineGap, foot);
    edge.delta = -dot(foot, normal);
    edge.l = dot(foot, cross(along, normal));
    const T half = root(positivePart(1 - edge.delta * edge.delta - edge.l * edge.l));
    edge.from = select(edge.x0 > -half, edge.x0, -half);
    edge.to = select(edge.x1 < half, edge.x1, half);
    return edge;
  }

  /// By its edges.
  WEIR_HD static TriangleTerms<T> termsOfEdges(const Triangle& triangle) {
    Edge edges[3];
    Mask cut = makesEdge(triangle, 0, edges), around = edges[0].l > T(0);
    for (int k = 1; k < 3; ++k) {
      cut = cut | makesEdge(triangle, k, edges);
      around = around & (edges[k].l > T(0));
    }
    TriangleTerms<T> terms = noTerms(triangle);
    if (any(cut)) {
      for (const Edge& edge : edges) addFan(edge, triangle, terms);
      terms.phi = zeroUnless(cut, terms.phi);
      terms.d = zeroUnless(cut, terms.d);
      terms.area = zeroUnless(cut, terms.area);
    }
    const Mask whole = around & !cut;
    if (any(whole)) addOuter(triangle.side, zeroUnless(whole, T(2 * kPi)), magnitude(triangle.delta), terms);
    return terms;
  }

  /// (4) for the part [0, x] of the edge. With the sign of the plane's side instead of |δ| it stays
  /// continuous if the edge's own δ has the other sign by rounding.
  WEIR_HD static T fanAngle(const Edge& edge, const T& x, const T& side) {
    const T l = magnitude(edge.l), delta = side * edge.delta;
    const T r = root(delta * delta + l * l + x * x);
    const T fan = side * angleOf(x * l * (r - delta), l * l * r + x * x * delta);
    return select(edge.l < T(0), -fan, fan);
  }

  static constexpr Real kPi = Real(3.14159265358979323846);

 private:
  /// How near p may come to a corner and to the line of an edge, in H.
  static constexpr Real kCornerGap = std::is_same_v<T, double> ? Real(1e-9) : Real(1e-5);
  static constexpr Real kLineGap = kCornerGap * Real(1e-4);

  // Of numbers in the standard library, of Lanes beside them.
  WEIR_HD static T root(const T& a) {
    if constexpr (std::is_floating_point_v<T>)
      return std::sqrt(a);
    else
      return sqrtf(a);
  }
  WEIR_HD static T magnitude(const T& a) {
    if constexpr (std::is_floating_point_v<T>)
      return std::abs(a);
    else
      return abs(a);
  }
  WEIR_HD static T angleOf(const T& y, const T& x) {
    if constexpr (std::is_floating_point_v<T>)
      return std::atan2(y, x);
    else
      return atan2(y, x);
  }

  WEIR_HD static Vec3<T> chosen(const Mask& mask, const Vec3<T>& a, const Vec3<T>& b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
  }

  /// The zero vector for the zero vector.
  WEIR_HD static Vec3<T> unit(const Vec3<T>& a) {
    const T l = root(dot(a, a));
    const Mask is = l > T(0);
    return {zeroUnless(is, a.x / l), zeroUnless(is, a.y / l), zeroUnless(is, a.z / l)};
  }

  /// Whether not all of three numbers are above 1 or below -1.
  WEIR_HD static Mask isWithin(const T& a, const T& b, const T& c) {
    return !(((a > T(1)) & (b > T(1)) & (c > T(1))) | ((a < T(-1)) & (b < T(-1)) & (c < T(-1))));
  }

  /// An arbitrary direction that edges of meshes are not likely to have.
  WEIR_HD static Vec3<T> aside() { return {T(Real(0.3523)), T(Real(0.8129)), T(Real(0.4637))}; }

  WEIR_HD Vec3<T> relative(const Vec3<T>& corner) const {
    const Vec3<T> r = (corner - p_) * T(inverseRadius_);
    return chosen(dot(r, r) < T(kCornerGap * kCornerGap), aside() * T(kCornerGap), r);
  }

  WEIR_HD static TriangleTerms<T> noTerms(const Triangle& triangle) {
    return {T(0), T(0), T(0), triangle.normal, triangle.delta};
  }

  WEIR_HD static Mask makesEdge(const Triangle& triangle, int k, Edge (&edges)[3]) {
    edges[k] = makeEdge(triangle.corner[k], triangle.corner[(k + 1) % 3], triangle.normal);
    return edges[k].from < edges[k].to;
  }

  // ---- Points inside

  /// Adds weight·∫ t·f(apex + t·m) dt over 0 ≤ t ≤ 1; without the distance of the plane.
  WEIR_HD static void addLine(const Vec3<T>& apex, const Vec3<T>& m, const T& weight,
                              TriangleTerms<T>& terms) {
    const T mm = dot(m, m), foot = -dot(apex, m) / mm;
    const Vec3<T> nearest = apex + m * foot;
    const T squared = dot(nearest, nearest);
    const Mask reached = squared < T(1);
    if (!any(reached)) return;
    const T reach = root(positivePart(1 - squared) / mm);
    const T from = select(foot > reach, foot - reach, T(0));
    const T to = select(foot + reach < T(1), foot + reach, T(1));
    const Mask cut = reached & (from < to);
    if (!any(cut)) return;
    // Like addInner: points are densest where f curves most.
    const Mask twice = (from < foot) & (foot < to);
    const T end = select(twice, foot, to);
    addPart({foot, squared, mm, from, end, weight}, cut, terms);
    if (any(cut & twice)) addPart({foot, squared, mm, end, to, weight}, cut & twice, terms);
  }

  struct LinePart {
    T foot, squared, mm;  // |y|² = squared + (t − foot)²·mm
    T from, to, weight;
  };

  WEIR_HD static void addPart(const LinePart& line, const Mask& counted, TriangleTerms<T>& terms) {
    // Gauss-Legendre, eight points or, where f hardly curves, four.
    const T size = line.to - line.from;
    const Mask curved = counted & (size * size * line.mm > line.squared), straight = counted & !curved;
    if (any(curved)) {
      const Real node[8] = {Real(-0.960289856497536), Real(-0.796666477413627), Real(-0.525532409916329),
                            Real(-0.183434642495650), Real(0.183434642495650),  Real(0.525532409916329),
                            Real(0.796666477413627),  Real(0.960289856497536)};
      const Real weight[8] = {Real(0.101228536290376), Real(0.222381034453374), Real(0.313706645877887),
                              Real(0.362683783378362), Real(0.362683783378362), Real(0.313706645877887),
                              Real(0.222381034453374), Real(0.101228536290376)};
      addPoints(line, node, weight, curved, terms);
    }
    if (any(straight)) {
      const Real node[4] = {Real(-0.861136311594053), Real(-0.339981043584856), Real(0.339981043584856),
                            Real(0.861136311594053)};
      const Real weight[4] = {Real(0.347854845137454), Real(0.652145154862546), Real(0.652145154862546),
                              Real(0.347854845137454)};
      addPoints(line, node, weight, straight, terms);
    }
  }

  /// The integrands of (1) and (2) at points of a line; G has the closed forms (1−r)⁴·(1 + 4r + 10r²)/(4π)
  /// for W and (1−r)³·(1 + 3r)·15/(4π) for |W'|/r.
  template <int kPoints>
  WEIR_HD static void addPoints(const LinePart& line, const Real (&node)[kPoints],
                                const Real (&weight)[kPoints], const Mask& counted, TriangleTerms<T>& terms) {
    const T middle = Real(0.5) * (line.from + line.to), half = Real(0.5) * (line.to - line.from);
    T sumW = 0, sumD = 0, sumArea = 0;
    for (int k = 0; k < kPoints; ++k) {
      const T t = middle + half * T(node[k]), x = t - line.foot;
      const T rr = line.squared + x * x * line.mm, r = root(rr);
      const T s = positivePart(1 - r), sss = s * s * s, share = weight[k] * t, overCube = share / (rr * r);
      sumW += overCube * sss * s * (1 + 4 * r + 10 * rr);
      sumD += overCube * sss * (1 + 3 * r);
      sumArea += share * sss;
    }
    const T scale = line.weight * half * (1 / (4 * kPi));
    terms.phi += zeroUnless(counted, scale * sumW);
    terms.d += zeroUnless(counted, scale * 15 * sumD);
    terms.area += zeroUnless(counted, scale * 60 * sumArea);
  }

  // ---- Edges

  /// Adds the fan between the foot of p and an edge.
  WEIR_HD static void addFan(const Edge& edge, const Triangle& triangle, TriangleTerms<T>& terms) {
    const Mask inside = edge.from < edge.to;
    const T endOfFirst = select(inside, edge.from, edge.x1);
    const Mask first = edge.x0 < endOfFirst, second = inside & (edge.to < edge.x1);
    T outer = 0;
    if (any(first)) outer = zeroUnless(first, angle(edge.l, edge.x0, endOfFirst));
    if (any(second)) outer += zeroUnless(second, angle(edge.l, edge.to, edge.x1));
    if (any(outer > T(0)))
      addOuter(triangle.side, select(edge.l < T(0), -outer, outer), magnitude(edge.delta), terms);
    if (!any(inside)) return;

    const T solidAngle =
        zeroUnless(inside, fanAngle(edge, edge.to, triangle.side) - fanAngle(edge, edge.from, triangle.side));
    terms.phi += solidAngle * (1 / (4 * kPi));
    terms.d += solidAngle * (15 / (4 * kPi));
    // R has its greatest curvature at x = 0, so the points are densest there.
    const Mask twice = inside & (edge.from < T(0)) & (edge.to > T(0));
    const T end = select(twice, T(0), edge.to);
    addInner(edge, edge.from, end, inside, terms);
    if (any(twice)) addInner(edge, end, edge.to, twice, terms);
  }

  /// The constants (3) over the angle ∫dθ, signed by the edge; q = |δ|.
  WEIR_HD static void addOuter(const T& side, const T& angle, const T& q, TriangleTerms<T>& terms) {
    const T t = positivePart(1 - q), t4 = t * t * t * t, turns = angle * (1 / (2 * kPi));
    terms.phi += side * turns * Real(0.5) * t4 * t * (1 + 2 * q);
    terms.d += side * turns * Real(7.5) * t4;
    terms.area += turns * Real(1.5) * t4 * (1 + 4 * q);
  }

  /// The antiderivatives (5) over the part [x0, x1] of the edge, all within the support.
  WEIR_HD static void addInner(const Edge& edge, const T& x0, const T& x1, const Mask& counted,
                               TriangleTerms<T>& terms) {
    // Gauss-Legendre on [-1, 1], five points.
    const Real node[5] = {Real(-0.906179845938664), Real(-0.538469310105683), 0, Real(0.538469310105683),
                          Real(0.906179845938664)};
    const Real weight[5] = {Real(0.236926885056189), Real(0.478628670499366), Real(0.568888888888889),
                            Real(0.478628670499366), Real(0.236926885056189)};
    const T q = magnitude(edge.delta), qq = q * q, rho = edge.l * edge.l + qq;
    const T middle = Real(0.5) * (x0 + x1), half = Real(0.5) * (x1 - x0);
    T w = 0, d = 0, area = 0;
    for (int k = 0; k < 5; ++k) {
      const T x = middle + half * T(node[k]), r = root(rho + x * x);
      // cₙ = (rⁿ − qⁿ)/(r² − q²)
      const T c1 = 1 / (r + q), c3 = r + qq * c1, c4 = r * r + qq, c5 = r * c4 + qq * qq * c1;
      w += weight[k] * (Real(1) / 6 - c3 * Real(0.25) + c4 * Real(0.15) - c5 * (Real(1) / 30));
      d += weight[k] * (c1 * Real(0.5) - Real(1) / 3 + c3 * (Real(1) / 12));
      area += weight[k] * (Real(0.5) - c3 + c4 * Real(0.75) - c5 * Real(0.2));
    }
    const T scale = edge.l * half * (15 / kPi), along = edge.delta * scale;
    terms.phi -= zeroUnless(counted, along * w);
    terms.d -= zeroUnless(counted, along * 3 * d);
    terms.area += zeroUnless(counted, scale * area);
  }

  /// The angle between the points xa ≤ xb of an edge, seen from the foot of p, in [0, π].
  WEIR_HD static T angle(const T& l, const T& xa, const T& xb) {
    return angleOf(magnitude(l) * (xb - xa), l * l + xa * xb);
  }

  Vec3<T> p_;
  Real inverseRadius_;
};

}  // namespace weir
