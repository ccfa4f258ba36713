// Particles near a segment, brought to the host, and sums over them at any place of it.
#pragma once

#include <optional>
#include <vector>

#include "nodes/gauge/particle_matter.h"

namespace weir {

/// Weighted sums at a place; `filled` = Σ V·W, the others divided by it.
struct LocalMatter {
  double filled = 0;
  Vec3d velocity;       ///< m/s
  double density = 0;   ///< kg/m³
  double pressure = 0;  ///< Pa
};

class NearParticles {
 public:
  /// Of those within 2 spacings of the segment from `a` to `b`, which may be the same place. Waits for the
  /// device.
  NearParticles(Device& device, const Particles& particles, const Vec3f& a, const Vec3f& b);

  /// At the place `along`, in [0, 1], between a and b.
  LocalMatter at(double along) const;

 private:
  Vec3d a_, direction_;  // to b, of length length_, in m
  double length_, reach_;
  std::vector<ParticleMatter> found_;  // by what stands in along_
  std::vector<double> along_;          // m from a in the direction of b, ascending
};

/// How fluid stands along a segment.
struct FluidOnLine {
  double height = 0;  ///< m from its beginning to the farthest place where it is filled by half; 0 if none
  double length = 0;  ///< m of it that are filled by half
};
FluidOnLine fluidOnLine(const NearParticles& near, double length, double spacing);

/// The indices of the particles within `reach` of the segment in `indices`, ascending, and how many.
template <class Backend>
void findNear(Backend& device, const Particles& particles, const Vec3f& a, const Vec3f& b, float reach,
              ArrayView<int> indices, int* found);
template <class Backend>
void gather(Backend& device, const MatterView& matter, ArrayView<const int> indices,
            ArrayView<ParticleMatter> to);

}  // namespace weir
