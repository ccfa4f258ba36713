// Room in a set before its particles come.
#pragma once

#include "framework/base/api.h"
#include "framework/particles/particle_set.h"

namespace WEIR_API weir {

/// For so many particles in an empty set. At once, as some attributes are there twice while a set grows.
inline void makeRoom(ParticleSet& empty, std::int64_t particles) {
  if (particles <= empty.capacity()) return;
  ParticleBatch batch;
  batch.count = particles;
  Array<int> none(empty.device(), 1);
  none.fillZero();
  empty.append(batch, {{nullptr, particles}, none.data()});
  empty.clear();
}

}  // namespace weir
