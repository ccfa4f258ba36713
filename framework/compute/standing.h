// What kernels may read before the kernel before them has ended.
#pragma once

namespace weir {

/// What stands while several kernels of a step run; each holds those before it. On CUDA a kernel may begin
/// while the one before it ends, and read ahead what that one leaves alone: a functor says so by
///
///   static constexpr Standing kLeaves = …, kReadsAhead = …;   // kNothing where it does not
///
/// If it reads lists ahead, it is for parallelForTeams alone or to be called with a TeamIndex, which it gives
/// to awaitBefore() before it reads anything else (packed_sum.h).
enum class Standing { kNothing, kCounts, kLists };  // numbers of elements, lists of neighbours

}  // namespace weir
