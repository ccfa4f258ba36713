// Drops in place of what a fluid's particles cannot resolve: single ones, and clouds that are thinner than a
// layer of them. As balls of the particles' size these look like beads, since water of that size does not
// hold together in air: the largest raindrops are 6 mm across (H. R. Pruppacher and J. D. Klett, Microphysics
// of Clouds and Precipitation, 1997, section 10.3.5).
#pragma once

#include "framework/base/api.h"
#include "framework/particles/particle_set.h"
#include "nodes/fluid_surface/particle_kernels.h"

namespace WEIR_API weir {

/// Whether a drop with the volume of a particle, d³, breaks up in air. `spacing`: d, m
bool breaksUp(float spacing);

class Spray {
 public:
  static constexpr int kDrops = 32;  ///< of each particle that is spray

  explicit Spray(Device& device)
      : chosen_(device), kept_(device, 1), positions_(device), velocities_(device), radii_(device) {}

  /// Replaces them: kDrops for each particle with a share s of spray above 0, of the volume s·d³ together in
  /// the mean. They go as fast, and are strewn around it: along each axis with a deviation of (1 + s)/2
  /// spacings, which is about the space that it has for itself, and along its way by up to kLag of it, but no
  /// more than three spacings. So those of neighbours mix, and a lone particle is no cluster with a rim. Its
  /// id alone decides where and how large, so that they stay as they are from frame to frame. Waits for the
  /// device.
  void make(Device& device, const ParticleKernels& kernels, const ParticleSet& particles, float spacing);

  std::int64_t size() const { return positions_.size(); }
  const Array<Vec3f>& positions() const { return positions_; }    ///< m
  const Array<Vec3f>& velocities() const { return velocities_; }  ///< m/s
  const Array<float>& radii() const { return radii_; }            ///< m
  static constexpr float kLag = 0.03f;                            ///< s
  /// The mean of the radii of a particle that is spray alone, in spacings. They are even between a half and
  /// three halves of it.
  static float meanRadius();

 private:
  template <class Backend>
  void chooseOn(Backend& device, ArrayView<const float> spray);
  template <class Backend>
  void placeOn(Backend& device, const ParticleKernels& kernels, const ParticleSet& particles, float spacing);

  Array<int> chosen_, kept_;
  Array<Vec3f> positions_, velocities_;
  Array<float> radii_;
};

}  // namespace weir
