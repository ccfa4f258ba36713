#include "nodes/particle_fluid/modules/capillary_force.h"

#include "framework/base/clamped.h"
#include "framework/compute/parallel.h"
#include "nodes/particle_fluid/fluid_sums.h"
#include "nodes/particle_fluid/modules/viscous_walls.h"
#include "nodes/particle_fluid/poly6_kernel.h"
#include "nodes/particle_fluid/scratch.h"
#include "nodes/particle_fluid/wall_field.h"
#include "nodes/static_boundary/boundary_clearance.h"

namespace weir {

namespace {

/// The share of the poly6 kernel behind a plane at q·H, q at least 0.
WEIR_HD float colorBehind(float q) {
  if (!(q < 1)) return 0;
  const float s = q * q;
  const float sum = q * (1 + s * (-4.0f / 3 + s * (6.0f / 5 + s * (-4.0f / 7 + s / 9))));
  return 0.5f - 315.0f / 256 * sum;
}

/// −H times its derivative by the distance.
WEIR_HD float colorSlope(float q) {
  const float t = positivePart(1 - q * q), square = t * t;
  return 315.0f / 256 * square * square;
}

/// ∇C of the half-space behind a wall, and which wall is nearest.
struct WallColor {
  float radius;  // H, m
  ArrayView<Vec3f> gradient;
  ArrayView<Vec4f> wall;

  WEIR_HD void add(std::int64_t i, float distance, const Vec3f& normal) const {
    const float h = positivePart(distance);
    gradient[i] -= (colorSlope(h / radius) / radius) * normal;
    if (h < wall[i].w) wall[i] = {normal.x, normal.y, normal.z, h};
  }
};

/// Solids given by meshes count as a plane behind which there is as much of the solver's kernel.
struct ColorGradient {
  NeighborView neighbors;
  Poly6Kernel kernel;
  float particleVolume, wallRadius, wallFactor;
  BoundaryView boundary;
  ArrayView<const Vec4f> ofMeshes;  // ∇Φ and Φ; empty before walls were found
  ArrayView<const Vec3f> positions;
  WallColor walls;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    Vec3f sum{};
    forEachNeighbor(i, neighbors, [&](int j) { sum += kernel.gradient(p - positions[j]); });
    walls.gradient[i] = particleVolume * sum;
    walls.wall[i] = {0, 0, 0, walls.radius};
    if (i < ofMeshes.size) addMeshes(i, ofMeshes[i]);
    if (!mayTouch(boundary, walls.radius, p)) return;
    forEachPiece(boundary, [&](const BoundaryPiece& piece) {
      forEachWall(piece, p, [&](float distance, const Vec3f& normal) { walls.add(i, distance, normal); });
    });
  }

 private:
  WEIR_HD void addMeshes(std::int64_t i, const Vec4f& found) const {
    const float steep = length(xyz(found));
    if (steep > 0) walls.add(i, planeOf(found.w / wallFactor) * wallRadius, xyz(found) / -steep);
  }
};

/// A surface that meets a wall.
struct Contact {
  float spacing, radius, cosine, sine;

  /// The normal n, turned to the angle of contact the more the nearer the wall is, whose normal is w.
  WEIR_HD Vec3f turned(const Vec3f& n, const Vec3f& w, float distance) const {
    constexpr float kAll = 0.5f, kNone = 2.7f;  // spacings
    const Vec3f along = normalized(n - dot(n, w) * w);
    const float share = 1 - smoothStep(kAll * spacing, kNone * spacing, distance);
    return normalized(n + share * (sine * along - cosine * w - n));
  }
  /// How steep the colour g is along n, as if the surface went on behind the wall. Along the wall there is
  /// nothing of the gradient but that of the surface: of this, a part lies behind the wall. Where it is
  /// nearly parallel to the wall, as that of a film is, it is taken as it is.
  WEIR_HD float steepness(const Vec3f& g, const Vec3f& n, const Vec3f& w, float distance) const {
    constexpr float kParallel = 0.1f, kAcross = 0.5f;  // squared sines
    const float across = dot(n, w), sine2 = clamped(1 - across * across, kParallel, 1);
    const float seen = 1 - colorBehind(distance / (radius * std::sqrt(sine2)));
    const float plain = dot(g, n), extended = dot(g - dot(g, w) * w, n) / (sine2 * seen);
    return plain + smoothStep(kParallel, kAcross, sine2) * (extended - plain);
  }
};

struct Normal {
  NeighborView neighbors;
  Poly6Kernel kernel;
  Contact contact;
  float area;  // F
  ArrayView<const Vec3f> positions, gradient;
  ArrayView<const Vec4f> wall;
  ArrayView<Vec4f> normal;

  WEIR_HD void operator()(std::int64_t i) const {
    constexpr float kLeast = 0.1f;  // of H·|g|; within the fluid there is only noise
    const Vec3f p = positions[i], own = gradient[i];
    Vec3f sum = kernel.value0 * own;
    float weights = kernel.value0;
    forEachNeighbor(i, neighbors, [&](int j) {
      const float w = kernel.value(p - positions[j]);
      sum += w * gradient[j];
      weights += w;
    });
    const float steep = length(sum);
    normal[i] = steep * contact.radius > kLeast * weights ? at(own, sum / steep, wall[i]) : Vec4f{};
  }

 private:
  WEIR_HD Vec4f at(const Vec3f& g, const Vec3f& smooth, const Vec4f& near) const {
    const Vec3f w = xyz(near);
    const bool alone = !(near.w < contact.radius);
    const Vec3f n = alone ? smooth : contact.turned(smooth, w, near.w);
    const float along = alone ? dot(g, n) : contact.steepness(g, n, w, near.w);
    return {n.x, n.y, n.z, 2 * area * positivePart(along)};
  }
};

/// Σ w·x·xᵀ and Σ w·u·xᵀ of ways x and turns u within the tangent plane.
struct TangentFit {
  float aa = 0, ab = 0, bb = 0;
  float ua = 0, ub = 0, va = 0, vb = 0;

  WEIR_HD void add(float w, float a, float b, float u, float v) {
    aa += w * a * a, ab += w * a * b, bb += w * b * b;
    ua += w * u * a, ub += w * u * b, va += w * v * a, vb += w * v * b;
  }
  /// tr S and det S, at most `max` and its square; 0 where there is nothing to fit.
  WEIR_HD Vec2f curvature(float max) const {
    constexpr float kLift = 0.01f;  // for neighbours along one line
    const float lift = kLift * (aa + bb), p = aa + lift, q = bb + lift, det = p * q - ab * ab;
    if (!(det > 0)) return {};
    const float saa = (ub * ab - ua * q) / det, sab = (ua * ab - ub * p) / det;
    const float sba = (vb * ab - va * q) / det, sbb = (va * ab - vb * p) / det;
    const float square = max * max;
    return {clamped(saa + sbb, -2 * max, 2 * max), clamped(saa * sbb - sab * sba, -square, square)};
  }
};

struct Curvature {
  NeighborView neighbors;
  Poly6Kernel kernel;
  float max;  // of a principal curvature, 1/m
  ArrayView<const Vec3f> positions;
  ArrayView<const Vec4f> normal;
  ArrayView<Vec3f> curvature;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec4f own = normal[i];
    curvature[i] = {};
    if (!(own.w > 0)) return;
    const Vec3f p = positions[i], n = xyz(own);
    const bool alongX = n.x * n.x < 0.4f;
    const Vec3f a = normalized(cross(n, Vec3f{alongX ? 1.0f : 0.0f, alongX ? 0.0f : 1.0f, 0})),
                b = cross(n, a);
    TangentFit fit;
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec4f other = normal[j];
      const Vec3f way = positions[j] - p, turn = xyz(other) - n;
      fit.add(other.w * kernel.value(way), dot(way, a), dot(way, b), dot(turn, a), dot(turn, b));
    });
    const Vec2f found = fit.curvature(max);
    curvature[i] = {found.x, found.y, own.w};
  }
};

/// The mean by W·δ.
struct SmoothCurvature {
  NeighborView neighbors;
  Poly6Kernel kernel;
  ArrayView<const Vec3f> positions, curvature;
  ArrayView<Vec3f> smoothed;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f own = curvature[i], p = positions[i];
    smoothed[i] = own;
    if (!(own.z > 0)) return;
    float weights = kernel.value0 * own.z, mean = weights * own.x, gauss = weights * own.y;
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec3f other = curvature[j];
      const float w = other.z * kernel.value(p - positions[j]);
      weights += w;
      mean += w * other.x;
      gauss += w * other.y;
    });
    smoothed[i] = {mean / weights, gauss / weights, own.z};
  }
};

/// By volume, N/m³; with δ.
struct SurfaceForce {
  float tension, airPressure, depth, max;
  ArrayView<const Vec4f> normal;
  ArrayView<const Vec3f> once, twice;

  WEIR_HD Vec4f operator()(std::int64_t i) const {
    constexpr float kSharpen = 3;
    const Vec4f own = normal[i];
    const Vec3f k = once[i] + kSharpen * (once[i] - twice[i]);
    const float push = own.w * (tension * ofSurface(k.x, k.y) + airPressure);
    return {push * own.x, push * own.y, push * own.z, own.w};
  }

 private:
  WEIR_HD float ofSurface(float mean, float gauss) const {
    constexpr float kLeast = 0.3f;  // where it is bent into the fluid by more than particles show
    const float shrunk = 1 + depth * (mean + depth * gauss);
    return clamped((mean + 2 * depth * gauss) / (shrunk > kLeast ? shrunk : kLeast), -max, max);
  }
};

struct SumForce {
  SurfaceForce force;
  WEIR_HD CapillarySums operator()(std::int64_t i) const {
    const Vec4f f = force(i);
    return {f.x, f.y, f.z, f.w};
  }
};

struct AddForces {
  WEIR_HD CapillarySums operator()(const CapillarySums& a, const CapillarySums& b) const {
    return {a.x + b.x, a.y + b.y, a.z + b.z, a.area + b.area};
  }
};

struct PushSurface {
  SurfaceForce force;
  float factor;                        // dt/ρ0
  ArrayView<const CapillarySums> sum;  // what is to be left of it is nothing; empty where that is not known
  ArrayView<Vec3f> velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec4f f = force(i);
    if (f.w > 0) velocities[i] += factor * (xyz(f) - surplus(f.w));
  }

 private:
  WEIR_HD Vec3f surplus(float delta) const {
    if (sum.size == 0) return {};
    const CapillarySums all = sum[0];
    const double share = delta / all.area;
    return {float(share * all.x), float(share * all.y), float(share * all.z)};
  }
};

}  // namespace

template <class Backend>
void CapillaryForce::findNormals(Backend& device, FluidStep& fluid) {
  constexpr float kDegree = 3.14159265f / 180;
  const FluidConstants& c = fluid.constants;
  const NeighborView neighbors = fluid.neighbors.view();
  const Poly6Kernel kernel(c.supportRadius);
  const auto positions = fluid.particles.positions().read();
  const WallField& walls = fluid.walls;
  const WallColor color{c.supportRadius, gradient_.view(), wall_.view()};
  parallelFor(
      device, "color gradient", fluid.particles.count(),
      ColorGradient{neighbors, kernel, c.particleVolume, c.wallRadius, c.wallFactor, walls.boundary.boundary,
                    walls.empty() ? ArrayView<const Vec4f>{} : walls.total.view(), positions, color});
  fluid.exchange(gradient_.view());
  const float angle = contactAngle * kDegree;
  parallelFor(device, "surface normal", fluid.particles.count(),
              Normal{neighbors, kernel, Contact{c.spacing, c.supportRadius, std::cos(angle), std::sin(angle)},
                     static_cast<float>(surfaceFit(c.supportRadius / c.spacing).area), positions,
                     gradient_.view(), wall_.view(), normal_.view()});
}

template <class Backend>
void CapillaryForce::findCurvature(Backend& device, FluidStep& fluid) {
  const NeighborView neighbors = fluid.neighbors.view();
  const Poly6Kernel kernel(fluid.constants.supportRadius);
  const auto positions = fluid.particles.positions().read();
  const auto smooth = [&](Array<Vec3f>& from, Array<Vec3f>& to) {
    fluid.exchange(from.view());
    parallelFor(device, "smooth curvature", fluid.particles.count(),
                SmoothCurvature{neighbors, kernel, positions, from.view(), to.view()});
  };
  fluid.exchange(normal_.view());
  parallelFor(device, "curvature", fluid.particles.count(),
              Curvature{neighbors, kernel, 1 / fluid.constants.spacing, positions, normal_.view(),
                        curvature_.view()});
  smooth(curvature_, smoothed_);
  smooth(smoothed_, curvature_);
}

template <class Backend>
void CapillaryForce::stepOn(Backend& device, FluidStep& fluid) {
  fitScratch(fluid, gradient_, wall_, normal_, curvature_, smoothed_);
  if (sums_.size() == 0) sums_ = Array<CapillarySums>(fluid.device, 1);
  fluid.exchange({"position"});
  findNormals(device, fluid);
  findCurvature(device, fluid);
  const FluidConstants& c = fluid.constants;
  const double depth = surfaceFit(c.supportRadius / c.spacing).depth * c.spacing;
  const SurfaceForce force{tension,        airPressure,      static_cast<float>(depth), 1 / c.spacing,
                           normal_.view(), smoothed_.view(), curvature_.view()};
  const bool free = fluid.walls.empty() && fluid.walls.boundary.empty();
  if (free) sumOverRanks(device, "surface force", allOf(fluid), SumForce{force}, AddForces{}, sums_.data());
  parallelFor(device, "push surface", fluid.particles.count(),
              PushSurface{force, static_cast<float>(fluid.time.dt) / c.restDensity,
                          free ? std::as_const(sums_).view() : ArrayView<const CapillarySums>{},
                          fluid.particles.velocities().write()});
}

template void CapillaryForce::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
