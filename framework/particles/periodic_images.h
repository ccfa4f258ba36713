// Particles in space that repeats itself (period.h): a set that is its own neighbour.
//
//   images.wrap();                                // owned particles into the box
//   neighbors.sort(particles, …);
//   images.show();                                // of what is beside a face, beyond the opposite one
//   neighbors.list(particles);
//   …
//   images.refresh({"position", "velocity"});     // wherever neighbours are read next
//
// Images are the set's halo, so sums over neighbours find them and all else passes them by. The pair of a
// particle and an image is met once more from the other side, with the same numbers up to the rounding of
// positions: what it exchanges is exactly opposite.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/particles/particle_set.h"
#include "framework/particles/period.h"

namespace WEIR_API weir {

/// For kernels: whose image a particle of the set is.
struct ImageOwners {
  ArrayView<const int> owners;  // of the halo
  std::int64_t first = 0;       // of the halo's particles

  WEIR_HD std::int64_t operator()(std::int64_t j) const {
    return owners.size > 0 && j >= first ? owners[j - first] : j;
  }
};

class PeriodicImages {
 public:
  /// Neighbours are nearer than `reach`, m, which is at most half of the box along each axis of the period.
  PeriodicImages(ParticleSet& particles, const Period& period, float reach);

  const Period& period() const { return period_; }
  /// How many images there are for each of many particles that fill the box evenly.
  static double shareOf(const Period& period, float reach);

  void wrap();
  /// Images of the particles within reach of a face become the halo, with position and id. Waits for the
  /// device.
  void show();
  /// Replaces these attributes of the images by what their owners have.
  void refresh(std::initializer_list<std::string_view> attributes);
  /// The same for arrays that have an element for each particle of the set, the halo behind the others. Of
  /// four numbers, the first three are a position.
  void refresh(ArrayView<float> values);
  void refresh(ArrayView<Vec3f> values);
  void refresh(ArrayView<Vec4f> values);
  ImageOwners owners() const { return {owners_.view(), particles_.bound()}; }

 private:
  void shiftPositions();
  template <class T>
  void refreshAll(ArrayView<T> values);
  /// Fills `owners_` and `shifts_`.
  template <class Backend>
  void findOn(Backend& device);
  template <class Backend>
  void wrapOn(Backend& device);
  template <class Backend>
  void shiftOn(Backend& device);
  template <class Backend, class T>
  void refreshOn(Backend& device, ArrayView<T> values);

  ParticleSet& particles_;
  Period period_;
  float reach_;
  Array<int> firsts_;  // where the images of each owned particle begin
  Array<int> owners_;
  Array<Vec3f> shifts_;  // m
  Array<std::byte> buffer_;
};

}  // namespace weir
