// Pairs of a particle and a triangle near it, whose terms the CPU finds eight at a time: a particle has too
// few triangles to fill eight lanes, and they take different ways through the arithmetic.
#pragma once

#include "framework/geometry/triangle_tree.h"
#include "framework/solids/seen_sides.h"
#include "framework/solids/triangle_integrals.h"

#ifdef WEIR_HAS_LANES

namespace weir {

class TrianglePairs {
 public:
  static constexpr int kMax = 512;          // pairs
  static constexpr int kMaxParticles = 16;  // at a time

  /// Forgets all.
  void clear() { pairs_ = particles_ = 0; }
  bool hasRoom(int triangles) const { return particles_ < kMaxParticles && pairs_ + triangles <= kMax; }

  /// A particle at p (m, in the solid's frame) and the triangles that may be near it.
  void add(const Vec3f& p, const int* triangles, int count) {
    for (int k = 0; k < count; ++k) {
      corner_[pairs_ + k] = 3 * triangles[k];
      particle_[pairs_ + k] = particles_;
    }
    first_[particles_] = pairs_;
    point_[particles_++] = p;
    first_[particles_] = pairs_ += count;
  }

  /// Finds the terms of all pairs, for the support radius H in m. `turned` if what the triangles' normals
  /// point to is solid.
  void evaluate(const TriangleTreeView& tree, bool turned, float radius) {
    if (pairs_ == 0) return;
    const Corners corners{&tree.triangles[0].a, turned ? 2 : 1, turned ? 1 : 2};
    pad(corner_, pairs_), pad(particle_, pairs_);
    int edges = 0, fine = 0;
    for (int k = 0; k < pairs_; k += kEight) begin(corners, 1 / radius, k, edges, fine);
    finish(corners, 1 / radius, withEdges_, edges,
           [](const Triangle& triangle) { return Of::termsOfEdges(triangle); });
    finish(corners, 1 / radius, withPoints_, fine, [](const Triangle& triangle) {
      return Of::termsOfFine(triangle, Of::asFine(triangle, Of::minSquaredDistance(triangle)));
    });
  }

  /// Calls f(terms) for each triangle of a particle, in the order in which they were added; particles have
  /// the numbers 0, 1, …
  template <class F>
  void forEachTriangle(int particle, const F& f) const {
    for (int k = first_[particle]; k < first_[particle + 1]; ++k)
      f(TriangleTerms<float>{
          phi_[k], d_[k], area_[k], {normal_[0][k], normal_[1][k], normal_[2][k]}, delta_[k]});
  }
  /// Bits of SeenSide, of all its triangles together.
  int sidesSeen(int particle) const {
    int sides = 0;
    for (int k = first_[particle]; k < first_[particle + 1]; ++k) sides |= sides_[k];
    return sides;
  }

 private:
  using Of = TriangleIntegrator<Lanes>;
  using Triangle = Of::Triangle;
  static constexpr int kEight = Lanes::kCount;
  static constexpr int kRoom = kMax + kEight;

  /// The corners of triangles, as an array of vectors, and which of the three come second and third.
  struct Corners {
    const Vec3f* all;
    int second, third;
  };
  struct Loaded {
    Vec3<Lanes> p, a, b, c;
  };

  /// The last group of eight repeats the last entry.
  static void pad(int* entries, int count) {
    for (int k = count; k % kEight != 0; ++k) entries[k] = entries[count - 1];
  }

  [[gnu::always_inline]] Loaded load(const Corners& corners, const int* corner, const int* particle) const {
    return {gatherLanes(point_, particle), gatherLanes(corners.all, corner),
            gatherLanes(corners.all + corners.second, corner),
            gatherLanes(corners.all + corners.third, corner)};
  }

  /// Of the pairs k to k + 7: sides, and who has terms, which are zero until then.
  void begin(const Corners& corners, float inverseRadius, int k, int& edges, int& fine) {
    const Loaded at = load(corners, corner_ + k, particle_ + k);
    const auto sides = sidesOf(at.p, at.a, at.b, at.c);
    const unsigned front = sides.front.bits(), back = sides.back.bits();
    for (int l = 0; l < kEight; ++l)
      sides_[k + l] = static_cast<int>((front >> l & 1u) * kSeesFront | (back >> l & 1u) * kSeesBack);
    Triangle triangle;
    LaneMask reached =
        Of(at.p, inverseRadius).prepare(at.a, at.b, at.c, triangle) & (LaneInts::from(k) < pairs_);
    for (float* terms : {phi_, d_, area_, delta_, normal_[0], normal_[1], normal_[2]})
      Lanes(0.0f).store(terms + k);
    if (!any(reached)) return;
    zeroUnless(reached, triangle.delta).store(delta_ + k);
    for (int axis = 0; axis < 3; ++axis) zeroUnless(reached, triangle.normal[axis]).store(normal_[axis] + k);
    const Lanes squaredDistance = Of::minSquaredDistance(triangle);
    reached = reached & Of::isReached(squaredDistance);
    const LaneMask points = Of::asFine(triangle, squaredDistance).is;
    edges += storeChosen(withEdges_ + edges, LaneInts::from(k), (reached & !points).bits());
    fine += storeChosen(withPoints_ + fine, LaneInts::from(k), (reached & points).bits());
  }

  /// Of some pairs, whose terms `termsOf` finds.
  template <class Terms>
  void finish(const Corners& corners, float inverseRadius, int* pairs, int count, const Terms& termsOf) {
    if (count == 0) return;
    pad(pairs, count);
    for (int k = 0; k < count; k += kEight) {
      int corner[kEight], particle[kEight];
      for (int l = 0; l < kEight; ++l)
        corner[l] = corner_[pairs[k + l]], particle[l] = particle_[pairs[k + l]];
      const Loaded at = load(corners, corner, particle);
      Triangle triangle;
      Of(at.p, inverseRadius).prepare(at.a, at.b, at.c, triangle);
      const TriangleTerms<Lanes> terms = termsOf(triangle);
      // What repeats the last one writes the same.
      for (int l = 0; l < kEight; ++l) {
        phi_[pairs[k + l]] = terms.phi.v[l];
        d_[pairs[k + l]] = terms.d.v[l];
        area_[pairs[k + l]] = terms.area.v[l];
      }
    }
  }

  int pairs_ = 0, particles_ = 0;
  int first_[kMaxParticles + 1] = {};  // pair of each particle
  Vec3f point_[kMaxParticles + 1];     // with room for a vector of four numbers
  // Of each pair.
  int corner_[kRoom], particle_[kRoom], sides_[kRoom];
  float phi_[kRoom], d_[kRoom], area_[kRoom], delta_[kRoom], normal_[3][kRoom];
  // Pairs whose triangles have terms by their edges, and by points inside.
  int withEdges_[kRoom + kEight], withPoints_[kRoom + kEight];
};

}  // namespace weir

#endif
