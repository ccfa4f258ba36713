// The particles of a fluid by cells, for sums over those near any point, with the kernel
//
//   W(r) = 315/(64π·H³)·(1 − r²/H²)³        H = 1.5 spacings (Müller et al. 2003)
//
// of a radius of its own: what is found depends neither on the fluid's support nor on its solver. Sums go by
// cells around the point and, within one, by ids, so neither the shape of the grid nor the order of the
// particles changes their bits. On several ranks each has the particles that it owns, and behind these, in
// the order of places, those of others that are near (remote_fluid.h).
#pragma once

#include <numbers>

#include "framework/compute/cell_sort.h"
#include "framework/neighbors/cell_grid.h"
#include "framework/particles/particles.h"
#include "nodes/particle_fluid/displacement.h"

namespace weir {

/// Radius of the kernel, in spacings.
inline constexpr float kNearRadius = 1.5;

/// A particle of the fluid on another rank.
struct FluidPoint {
  Vec4f place;     ///< m, and the volume in m³
  Vec3f velocity;  ///< m/s
  std::int64_t id = 0;
};

struct FluidGridView {
  CellGrid grid;
  float radius = 1;                   ///< H, m
  ArrayView<const int> start;         ///< first place of each cell
  ArrayView<const Vec4f> places;      ///< m, and the volume in m³
  ArrayView<const Vec3f> velocities;  ///< m/s

  /// W(r)·H³ / (315/64π), from r².
  WEIR_HD float shape(float squared) const {
    const float rest = 1 - squared / (radius * radius);
    return rest * rest * rest;
  }
  WEIR_HD float factor() const {
    return static_cast<float>(315 / (64 * std::numbers::pi)) / (radius * radius * radius);
  }

  /// Calls f(place, offset from p, its square) for all particles closer to the finite point p than the
  /// radius.
  template <class F>
  WEIR_HD void forEachNear(const Vec3f& p, const F& f) const {
    forEachCellRow(p, [&](int first, int last) {
      for (int k = start[first]; k < start[last + 1]; ++k) {
        const Vec3f away = xyz(places[k]) - p;
        const float squared = dot(away, away);
        if (squared < radius * radius) f(k, away, squared);
      }
    });
  }

  /// Calls f(first, last) for runs of cells that together are the 27 around p.
  template <class F>
  WEIR_HD void forEachCellRow(const Vec3f& p, const F& f) const {
    const Vec3i at = grid.cellOf(p);
    const bool whole = at.x > 0 && at.x + 1 < grid.cells.x;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy) {
        Vec3i c{at.x, CellGrid::step(at.y, dy, grid.cells.y), CellGrid::step(at.z, dz, grid.cells.z)};
        const int middle = grid.index(c);
        if (whole) {
          f(middle - 1, middle + 1);
          continue;
        }
        for (int dx = -1; dx <= 1; ++dx) {
          c.x = CellGrid::step(at.x, dx, grid.cells.x);
          f(grid.index(c), grid.index(c));
        }
      }
  }
};

/// The fluid at a point.
struct FluidSample {
  float filled = 0;  ///< Σ V·W: 1 within fluid, 1/2 at a flat surface
  Vec3f velocity;    ///< Σ V·W·v / Σ V·W, m/s
  Vec3f middle;      ///< Σ V·W·x / Σ V·W from the point, m: into the fluid at a surface
};

WEIR_HD inline FluidSample fluidAt(const FluidGridView& fluid, const Vec3f& p) {
  float sum = 0;
  Vec3f momentum, moment;
  fluid.forEachNear(p, [&](int k, const Vec3f& away, float squared) {
    const float weight = fluid.places[k].w * fluid.shape(squared);
    sum += weight;
    momentum += weight * fluid.velocities[k];
    moment += weight * away;
  });
  if (!(sum > 0)) return {};
  return {fluid.factor() * sum, momentum / sum, moment / sum};
}

class FluidGrid {
 public:
  explicit FluidGrid(Device& device)
      : sorted_(device), kept_(device, 1), box_(device, 1), places_(device), velocities_(device) {}

  /// Bytes on the device for that many particles.
  static double memoryFor(double particles);

  /// The box around the particles that are finite; waits for the device.
  Aabb boxOf(const Particles& fluid);
  /// Chooses cells that suit where the particles are; waits for the device.
  void fit(const Particles& fluid);
  /// Sorts the particles as they are now, with those of other ranks; what is not finite is left out.
  template <class Backend>
  void sort(Backend& device, const Particles& fluid, ArrayView<const FluidPoint> beside);

  FluidGridView view() const;
  /// Which particle of the fluid stands at a place, those of others behind all, and how many places there
  /// are.
  ArrayView<const int> order() const { return sorted_.order(); }
  Count count() const { return {places_.size(), kept_.data()}; }
  std::int64_t cells() const { return grid_.cellCount(); }

 private:
  template <class Backend>
  void findBoxOn(Backend& device, const Particles& fluid);

  CellGrid grid_;
  float radius_ = 0;
  std::int64_t fittedFor_ = 0;  // particles
  CellSort sorted_;
  Array<int> kept_;
  Array<Aabb> box_;
  Array<Vec4f> places_;
  Array<Vec3f> velocities_;
};

}  // namespace weir
