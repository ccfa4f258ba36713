// The newest layers of emitters, which the fluid carries on as they were given: for 1.5 spacings a particle
// has the emitter's velocity and is where that takes it, whatever pushes it. It is let go when it has come
// that far from where it left, to a fraction of a step. At the end of a step, gravity would have it for up to
// a step more or less than its neighbours, by which layer: after half a second of flight a jet has ribs.
//
// Without that nothing is behind the newest layer. A pressure p moves it back by some p/K of a spacing until
// the next one comes, which is then that much too near, and pushed by as much more: in a stiff fluid a jet
// bursts, sideways at half its speed and more. With it jets leave as they were laid. A particle that
// something has moved by more than a tenth of a spacing is let go at once: a wall that stops it is not
// passed.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/graph/node.h"
#include "framework/graph/state.h"
#include "framework/particles/inflow_role.h"
#include "framework/particles/particle_batch.h"
#include "framework/particles/particle_set.h"

namespace weir {

class Inflow {
 public:
  explicit Inflow(Device& device) : device_(&device) {}

  /// Particles of a node that flows in, which the set is about to take at `time`; `source` tells nodes apart.
  void add(const ParticleBatch& born, int source, const FlowsIn::Flow& flow, double time,
           const ParticleSet& particles);
  /// At the beginning of a step: those that are still carried are where they should be. Those that are let go
  /// in it start so that gravity, which has them for all of it, takes them to where they would be.
  void carry(ParticleSet& particles, const StepContext& context, float spacing);

  void save(const StateWriter& to) const;
  void restore(const StateReader& from);

 private:
  /// What one node gave in one step, where it was then.
  struct Batch {
    Array<Vec3f> positions, velocities;
    std::int64_t firstId = 0;
    double born = 0;  // s, when that step began
    FlowsIn::Flow flow;
    int source = 0;
  };
  template <class Backend>
  void carryOn(Backend& device, const Batch& batch, ParticleSet& particles, const StepContext& context,
               float spacing);

  static constexpr double kCarried = 1.5;  // spacings

  Device* device_;
  std::vector<Batch> batches_;  // the oldest first
};

}  // namespace weir
