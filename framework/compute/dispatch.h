// From a Device to the kernels of its back end.
//
// What a target is compiled with (WEIR_HAS_CUDA, WEIR_HAS_AVX2) matters here and in few other places, so that
// all other sources are compiled alike with and without CUDA, and ccache compiles them once.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/device.h"

namespace WEIR_API weir {

namespace detail {
/// Throws the simulation Error of a library that was built without nvcc and is asked to run on CUDA.
[[noreturn]] void throwNoCudaKernels();
}  // namespace detail

/// Calls f with the device as its back end's own class. A plugin may be built without CUDA for a Weir that
/// has it; its kernels then refuse a CUDA device with a simulation Error.
template <class F>
decltype(auto) dispatch(Device& device, F&& f) {
#ifdef WEIR_HAS_CUDA
  if (device.kind() == DeviceKind::kCuda) return f(static_cast<CudaDevice&>(device));
#else
  if (device.kind() == DeviceKind::kCuda) detail::throwNoCudaKernels();
#endif
  CpuDevice& cpu = static_cast<CpuDevice&>(device);
#ifdef WEIR_HAS_AVX512
  if (cpu.isa() == CpuIsa::kAvx512) return f(static_cast<CpuAvx512&>(cpu));
#endif
#ifdef WEIR_HAS_AVX2
  if (cpu.isa() == CpuIsa::kAvx2) return f(static_cast<CpuAvx2&>(cpu));
#endif
  return f(cpu);
}

}  // namespace weir
