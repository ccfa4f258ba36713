// What the particles of a fluid feel of walls: the integrals of solid_integrals.h. Those of rigid meshes, all
// together and each alone, are found where neighbours are: at the predicted positions, and where a solver
// searches again. At a distance w from there Φ is Φ + ∇Φ·w + ½·w·K·w, K being the part of ∇∇Φ that is due to
// the distances of planes ((7) of solid_integrals.h), or without K in solvers that do not ask for it. Without
// K nothing resists a particle in the edge of a container that leaves one wall and goes through the other.
// As ∇Φ grows along w, Φ is nowhere below its least value on the way to w. Those of boundaries, by signed
// distance, are functions of a particle's place (boundary_integrals.h), and found wherever they are asked
// for.
//
// All integrals here are a times those of the kernel with radius H_w (WallKernel), Φ being its Ψ. λ gains Φ,
// and a wall pushes with Ḃ·∇Φ. Its displacement of a particle is share·∇Φ, where the solver sums the share
// over its iterations, and with K a remainder that is not along ∇Φ; so what the fluid gains from walls is
// exactly known, and solids get its opposite.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/symmetric_tensor.h"
#include "framework/compute/compact_once.h"
#include "framework/compute/eight.h"
#include "framework/particles/particle_set.h"
#include "framework/solids/solid_pairs.h"
#include "nodes/particle_fluid/body_sums.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/fluid_constants.h"
#include "nodes/static_boundary/boundary_integrals.h"

namespace WEIR_API weir {

struct FluidRoom;

/// What walls give to the push of a particle.
template <class T>
struct WallPush {
  Vec3<T> gradPhi{};  ///< 1/m
  T d = 0;            ///< 1/m²
  T steepness = 1;    ///< of meshes, ∇Φ along ∇Φ where it was found, over that
};

/// For kernels of solvers; empty where a fluid meets no walls. `Boundary` is BoundaryIntegrals or, where that
/// is enough, BoxBoundary or NoBoundary.
template <class Boundary>
struct WallFieldViewWith {
  ArrayView<const Vec4f> integrals;  ///< ∇Φ [1/m] and Φ, of all solids together
  ArrayView<const float> d;          ///< D, 1/m²
  ArrayView<float> share;            ///< m², see above; empty where nobody asks for it
  ArrayView<const Vec3f> foundAt;    ///< positions at which integrals of meshes were found
  /// K, 1/m²: xx, yy, zz and xy, xz, yz. Empty for a solver that does not ask for it.
  ArrayView<const Vec3f> curvature, curvatureOff;
  Boundary boundary;
  // Only where forces move a solid, see body_coupling.h.
  ArrayView<const float> lift;  ///< what the solids' own displacements take from Φ
  ArrayView<float> grip;        ///< m²: by how much the share follows Φ in an iteration

  WEIR_HD bool empty() const { return integrals.size == 0 && boundary.empty(); }
  /// Φ of a particle, or of eight, at x.
  template <class Index, class T>
  WEIR_HD T phi(Index i, const Vec3<T>& x) const {
    T sum = boundary.empty() ? T(0) : boundary.at(x).phi;
    if (integrals.size == 0) return sum;
    const Vec4<T> found = read(integrals, i);
    const auto feels = found.w > T(0);
    if (!any(feels)) return sum;
    return sum + zeroUnless(feels, positivePart(ofMeshes(i, x, found).phi));
  }
  /// ∇Φ and D there.
  template <class Index, class T>
  WEIR_HD WallPush<T> push(Index i, const Vec3<T>& x) const {
    WallPush<T> sum;
    if (!boundary.empty()) {
      const SolidIntegrals<T> of = boundary.at(x);
      sum.gradPhi = of.gradPhi;
      sum.d = of.d;
    }
    if (integrals.size == 0) return sum;
    const T dOfMeshes = positivePart(read(d, i));
    const auto feels = dOfMeshes > T(0);
    if (!any(feels)) return sum;
    sum.d += dOfMeshes;
    // Of eight, a particle that feels no mesh gets nothing of its gradient, as if it were alone.
    const Vec4<T> found = read(integrals, i);
    const Vec3<T> gradient = curvature.size > 0 ? ofMeshes(i, x, found).gradient : xyz(found);
    sum.gradPhi +=
        Vec3<T>{zeroUnless(feels, gradient.x), zeroUnless(feels, gradient.y), zeroUnless(feels, gradient.z)};
    if (curvature.size == 0) return sum;
    const T square = dot(xyz(found), xyz(found));
    const auto steep = feels & (square > T(0));
    sum.steepness = select(steep, dot(gradient, xyz(found)) / select(steep, square, T(1)), T(1));
    return sum;
  }
  WEIR_HD Vec3f gradientOfBoundary(const Vec3f& x) const {
    return boundary.empty() ? Vec3f{} : boundary.at(x).gradPhi;
  }
  /// What shares are over: ∇Φ of boundaries at x, and of meshes where they were found.
  WEIR_HD Vec3f sharedGradient(std::int64_t i, const Vec3f& x) const {
    Vec3f sum = gradientOfBoundary(x);
    if (integrals.size > 0 && d[i] > 0) sum += xyz(integrals[i]);
    return sum;
  }

 private:
  template <class T>
  struct Extrapolated {
    T phi;
    Vec3<T> gradient;  // only with K
  };
  template <class Index, class T>
  WEIR_HD Extrapolated<T> ofMeshes(Index i, const Vec3<T>& x, const Vec4<T>& found) const {
    const Vec3<T> way = x - read(foundAt, i);
    const T slope = dot(xyz(found), way);
    if (curvature.size == 0) {
      const T phi = found.w + slope;
      return {lift.size > 0 ? phi - read(lift, i) : phi, {}};
    }
    const Vec3<T> bend = SymmetricTensorOf<T>{read(curvature, i), read(curvatureOff, i)} * way;
    const T growth = dot(way, bend);
    // Part of the way to where Φ would be least on it.
    const auto past = (slope < T(0)) & (slope + growth > T(0));
    const T part = select(past, slope / select(past, -growth, T(1)), T(1));
    const T phi = found.w + part * (slope + 0.5f * part * growth);
    const T felt = zeroUnless(phi > T(0), part);
    return {phi, felt * (xyz(found) + part * bend)};
  }
};
using WallFieldView = WallFieldViewWith<BoundaryIntegrals>;

/// How near particles may come to a solid, in spacings. The pressure keeps the fluid at about half a spacing;
/// this is far below that, and far above the rounding of coordinates.
inline constexpr float kSolidGap = 0.1f;

/// Kept by the fluid; the modules SolidApproach, WallIntegrals and SolidContact fill and use it.
struct WallField {
  explicit WallField(Device& device)
      : views(device),
        grid(device),
        pairs(device),
        each(device),
        sides(device),
        total(device),
        foundAt(device),
        curvature(device),
        curvatureOff(device),
        d(device),
        legal(device),
        marks(device),
        met(device),
        metCounter(device, 1),
        kick(device),
        hits(device),
        impulses(device),
        lift(device),
        grip(device),
        bodySums(device),
        measured(device),
        boundaryImpulses(device),
        velocitiesBefore(device),
        pieces_(device) {}

  std::vector<Solid*> solids;
  Array<SolidView> views;  ///< of the solids, in this step
  SolidGrid grid;          ///< of the solids, as `views` has them
  SolidPairs pairs;        ///< of particles and the solids within their support radius
  Array<Vec4f> each;       ///< integrals of each pair
  Array<int> sides;        ///< of its solid that its particle sees, see hidden_neighbors.h
  Array<Vec4f> total;      ///< integrals of each particle
  Array<Vec3f> foundAt, curvature, curvatureOff;  ///< see WallFieldView
  Array<float> d;
  Attribute<float> share;  ///< an attribute, as particles may be sorted during a step
  Array<Vec3f> legal;      ///< positions that lie in no solid, at the end of the step
  /// Particles that are near solids are few, so they are listed, and what is costly is done for them alone.
  Array<std::uint8_t> marks;  ///< of those that are to be listed; scratch
  Array<int> met;             ///< that may have met a solid on their way; scratch
  Array<int> metCounter;      ///< one: how many
  /// Of met[k]: change of velocity by contact, m/s, and the number of the solid, -1 for none.
  Array<Vec4f> kick;
  KeyLists hits;  ///< places in `met` of the particles that each solid stopped, if they are many
  Array<SolidImpulse> impulses;  ///< two of each solid, scratch
  Array<float> lift, grip;       ///< see WallFieldView
  Array<BodySums> bodySums;      ///< of each solid, scratch
  std::int64_t stride = 0;
  bool rubs = false, bounces = false;  ///< whether a boundary has friction, and restitution
  /// A boundary that reports forces, or a part of the last one before it.
  struct Measured {
    SolidImpulse* impulse;  ///< one sum, of all steps
    Vec3f pivot;
    int parts;  ///< how many there are behind it; 0 of a part
    Aabb box;   ///< m, of a part: where fluid is that pushes it
  };
  Array<Measured> measured;
  Array<SolidImpulse> boundaryImpulses;  ///< one of each of these, scratch
  Array<Vec3f> velocitiesBefore;  ///< before contacts with boundaries, where these report forces; scratch
  bool still = false;   ///< whether solids stand where they are at time 0, until the simulation starts
  bool moves = false;   ///< whether the fluid moves solids in this step
  bool moved = false;   ///< whether a solver has done so
  bool curves = false;  ///< whether the solver asks for K
  /// Displacement by meshes in this step, beside share·∇Φ, m; empty if there is none.
  ArrayView<const Vec3f> remainder;

  BoundaryIntegrals boundary;  ///< of all boundaries together

  /// Whether there are no meshes.
  bool empty() const { return solids.empty(); }
  /// Whether forces move any of the solids.
  bool hasBodies() const;
  /// Whether solvers follow what walls do to each particle.
  bool keepsShares() const { return !empty() || rubs || reports(); }
  /// Whether a boundary reports forces.
  bool reports() const { return measured.size() > 0; }
  WallFieldView view() { return viewWith(boundary); }
  /// Calls f with view() or, where that is all, with a view of one box or of no boundary.
  template <class F>
  void withView(const F& f) {
    if (boundary.empty())
      f(viewWith(NoBoundary{}));
    else if (boundary.isOneBox())
      f(viewWith(boundary.oneBox()));
    else
      f(view());
  }
  /// The solids by signed distance that the fluid meets.
  void meet(const std::vector<const Boundary*>& boundaries, const FluidConstants& constants,
            ParticleSet& particles);
  /// Lists the particles i, of `count`, for which is(i) holds.
  template <class Backend, class Is>
  void list(Backend& device, std::string_view name, Count count, const Is& is, Array<int>& indices,
            Array<int>& counter);
  /// Lists by solids whom these have stopped, once that is known.
  template <class Backend>
  void listHits(Backend& device);
  /// Brings `grid` up to date once solids have moved.
  template <class Backend>
  void sortSolids(Backend& device) {
    grid.sort(device, std::as_const(views).view());
  }
  /// Fills `pairs`, and makes room for what is known of each.
  template <class Backend>
  void findPairs(Backend& device, Count count, ArrayView<const Vec3f> positions, float reach);
  Count metCount() const { return {stride, metCounter.data()}; }
  KeyListsView hitsBySolid() const { return hits.view(); }
  /// The solids as they move from `time` on for `dt` seconds; with dt = 0, as they stand then. `gravity`
  /// (m/s²) is that of those that forces move.
  void place(double time, double dt, const Vec3f& gravity = {});
  /// Takes the present positions for legal ones.
  void keepLegal(const ArrayView<const Vec3f>& positions) { copyAll(positions, legal); }
  /// And for those at which integrals are found.
  void keepFoundAt(const ArrayView<const Vec3f>& positions) { copyAll(positions, foundAt); }
  /// No displacement by walls yet; at the beginning of a solver's step.
  void forgetShares() {
    if (keepsShares()) share.fillZero();
    if (moves) grip.fillZero();
  }
  /// What walls have felt so far, in steps that are not part of the run.
  void forgetImpulses();
  /// Room for all particles in all arrays; contents are undefined.
  void fit(ParticleSet& particles);
  /// Bytes that this takes on the device, with that many solids.
  double memoryFor(const FluidRoom& room) const;

 private:
  template <class Boundary>
  WallFieldViewWith<Boundary> viewWith(const Boundary& of) {
    WallFieldViewWith<Boundary> result{.boundary = of};
    if (keepsShares()) result.share = share.write();
    if (empty()) return result;
    result.integrals = std::as_const(total).view();
    result.d = std::as_const(d).view();
    result.foundAt = std::as_const(foundAt).view();
    if (curves)
      result.curvature = std::as_const(curvature).view(),
      result.curvatureOff = std::as_const(curvatureOff).view();
    if (moves) result.lift = std::as_const(lift).view(), result.grip = grip.view();
    return result;
  }
  void addShare(ParticleSet& particles);
  void copyAll(const ArrayView<const Vec3f>& from, Array<Vec3f>& to) const {
    to.device().copy(to.data(), from.data, static_cast<std::size_t>(stride) * sizeof(Vec3f));
  }

  std::vector<SolidView> placed_;                // what `views` held before forces moved some
  std::size_t sortedSolids_ = 0;                 // that `grid` is for
  float reach_ = 0, gap_ = 0;                    // m
  std::vector<Array<SolidImpulse>*> reporting_;  // what `measured` points to
  Array<BoundaryPiece> pieces_;
};

template <class Backend, class Is>
void WallField::list(Backend& device, std::string_view name, Count count, const Is& is, Array<int>& indices,
                     Array<int>& counter) {
  compactOnce(device, name, count, is, marks, indices.view(), counter.data());
}

namespace detail {

/// The solid that has stopped particle met[m].
struct WriteHits {
  ArrayView<const Vec4f> kick;
  ArrayView<std::uint32_t> keys;
  ArrayView<int> items;

  WEIR_HD void operator()(std::int64_t m) const {
    const int k = static_cast<int>(kick[m].w);
    if (k >= 0) keys[m] = static_cast<std::uint32_t>(k);
    items[m] = static_cast<int>(m);
  }
};

}  // namespace detail

template <class Backend>
void WallField::listHits(Backend& device) {
  hits.forget();
  if (KeyLists::areFew(views.size())) return;
  hits.clear(device, metCount());
  parallelFor(device, "hits", metCount(),
              detail::WriteHits{std::as_const(kick).view(), hits.keys(), hits.items()});
  hits.sort(device, views.size());
}

template <class Backend>
void WallField::findPairs(Backend& device, Count count, ArrayView<const Vec3f> positions, float reach) {
  // The grid knows of nothing farther off.
  const SolidGridView known = reach > reach_ ? SolidGridView{} : grid.view();
  pairs.find(device, count, std::as_const(views).view(), known, positions, reach);
  each.resizeDiscarding(pairs.room());
  sides.resizeDiscarding(pairs.room());
}

}  // namespace weir
