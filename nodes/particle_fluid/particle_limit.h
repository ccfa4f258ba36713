// How many particles a fluid may have.
//
// Each rank counts what it holds by 32 bits, and so does the first one where it gathers all. Ids, counts of
// all and sums have 64 bits; exact sums (exact_sum.h) have room for 2^32 terms.
#pragma once

#include <functional>
#include <string>

#include "framework/base/api.h"

namespace WEIR_API weir {

struct ParticleOutlook {
  double all = 0;         ///< particles at most
  double onRank = 0;      ///< of a rank, with copies of others'
  int ranks = 0;          ///< 0 where nobody shares them
  bool gathered = false;  ///< by the first rank
  double spacing = 0;     ///< m
};

/// Throws a scene Error where these are too many. `remedy` as MemoryNeeds has it.
void checkParticleCount(const ParticleOutlook& outlook,
                        const std::function<std::string(double share)>& remedy);

}  // namespace weir
