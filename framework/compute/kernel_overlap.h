// Kernels of a graph that begin while the one before them ends ("programmatic dependent launch").
//
// Most of the time between two kernels goes by with setting up the second one. It may be set up as soon as
// all blocks of the first have done their work, if it then waits until what they wrote is there. For CUDA
// sources only.
//
// A kernel may read ahead, that is, before it waits: what the kernel before it leaves alone, and those before
// that one have written. They have ended and what they wrote is there, because that one waited for them
// before it let this one begin; still, to be sure of no old line in a multiprocessor's own cache, such reads
// go past it (loadPastCache). Whether the kernel before does leave it alone is for the queue to see: by
// `Overlap`.
#pragma once

namespace weir::detail {

/// First of all in a kernel, but for what it reads ahead. All of its threads come to it.
__device__ inline void waitForPriorKernel() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.wait;" ::: "memory");
#endif
}

/// Last in a kernel: the next one's blocks may take the place of this block. Earlier they would take the
/// place of blocks of this kernel.
__device__ inline void triggerDependentKernel() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.launch_dependents;" ::: "memory");
#endif
}

}  // namespace weir::detail
