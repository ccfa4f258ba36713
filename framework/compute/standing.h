// What kernels may read before the kernel before them has ended, and how that is said where they are
// launched.
#pragma once

#include "framework/base/api.h"

namespace WEIR_API weir {

/// What stands while several kernels of a step run; each holds those before it. On CUDA a kernel may begin
/// while the one before it ends, and read ahead what that one leaves alone. A launch policy says so, a type
/// with
///
///   static constexpr Standing kLeaves = …, kReadsAhead = …;   // kNothing where it does not
///   static constexpr int kBlocksTogether = …;                 // or without it, see parallel_cuda.inl
///
/// What reads lists ahead is for parallelForTeams alone or to be called with a TeamIndex, which it gives to
/// awaitBefore() before it reads anything else (packed_sum.h).
enum class Standing { kNothing, kCounts, kLists };  // numbers of elements, lists of neighbours

/// A functor with the policy of one launch.
template <class Policy, class F>
struct Launched : F, Policy {};

/// parallelFor(device, name, count, launched<Policy>(f)).
template <class Policy, class F>
Launched<Policy, F> launched(const F& f) {
  return {f, {}};
}

}  // namespace weir
