// Kernels of a graph that begin while the one before them ends ("programmatic dependent launch").
//
// Most of the time between two kernels goes by with setting up the second one. It may be set up as soon as
// all blocks of the first have done their work, if it then waits until what they wrote is there. For CUDA
// sources only.
#pragma once

namespace weir::detail {

/// First of all in a kernel that is submitted with LaunchShape::waits.
__device__ inline void awaitWhatIsBefore() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.wait;" ::: "memory");
#endif
}

/// Last in a kernel: the next one's blocks may take the place of this block. Earlier they would take the
/// place of blocks of this kernel.
__device__ inline void letNextBegin() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.launch_dependents;" ::: "memory");
#endif
}

}  // namespace weir::detail
