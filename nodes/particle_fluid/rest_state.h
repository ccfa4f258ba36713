// Lets a fluid's initial particles come to rest before the simulation starts.
//
// A sampler gives each batch a container, the region that it fills. Steps of the fluid's own pipeline, with
// its gravity, boundaries and solver, are taken with velocities damped and every particle kept in its batch's
// container, until the fluid is at rest there: its pressure is hydrostatic, and its layers at walls are those
// that the walls make. Then every particle gets the velocity, and what else its sampler gave it: modules have
// worked on that, too. Particles without a container stay where they are meanwhile.
//
// Pressure is for fluid that the scene holds: where a container vanishes that had carried the fluid, what is
// stored in the pressure would be let go. So a batch may be told to find out (StartPressure): once its
// container carries more than a small share of its weight, it goes on without gravity.
#pragma once

#include <functional>
#include <vector>

#include "framework/compute/exact_sum.h"
#include "framework/particles/initial_division.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

class RestState {
 public:
  /// The batches that the fluid's particles came from, in their order, all of them and nothing else.
  RestState(FluidStep& fluid, const std::vector<SharedBatch>& batches);

  /// Whether there is a container at all.
  bool wanted() const;
  /// Takes at most `max` steps, by calling `step`; says how many.
  int reach(int max, const std::function<void()>& step);

 private:
  template <class Backend>
  void dampOn(Backend& device, float kept);
  template <class Backend>
  void containOn(Backend& device);
  template <class Backend>
  void releaseOn(Backend& device);
  /// Attributes that batches brought are what these brought, 0 elsewhere.
  template <class Backend>
  void giveBackOn(Backend& device);
  template <class Backend>
  double meanSquareSpeedOn(Backend& device);
  template <class Backend>
  void findCarriedOn(Backend& device);
  /// Of particles that are held where they are: each takes its place along.
  void keepPlaces();
  /// Takes the weight from batches that were not held during the last steps, of this number; says whether
  /// there were any.
  bool unloadUnheld(int steps);

  /// A batch, and how it rests.
  struct Resting {
    const ParticleBatch* batch;
    std::int64_t count;  ///< of all ranks
    bool weightless;
    double carried = 0;  ///< share of its weight that its container carries, summed over steps since a stop
    bool undecided() const { return batch->pressure == StartPressure::kAuto && !weightless; }
  };

  FluidStep& fluid_;
  std::vector<Resting> batches_;
  /// Of all ranks.
  double sumOfAll();

  Array<ExactSum> sum_;
  bool holdsParts_ = false;  // whose places this rank has not in the batch
  Attribute<Vec3f> places_;  // of each particle, if so
};

}  // namespace weir
