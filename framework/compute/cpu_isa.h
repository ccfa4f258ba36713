// The instruction sets that kernels on the CPU are compiled for, and the choice among them at run time.
//
// Every *.dual.cpp is compiled for each of them (weir_add_sources in cmake/): for the processors that the
// whole build is for, for x86-64-v3 (AVX2) and for x86-64-v4 (AVX-512). Without contraction to fused
// operations and with sums in one order, all of them give the same results, bit for bit.
#pragma once

#include <string_view>
#include <vector>

#include "framework/base/api.h"

namespace WEIR_API weir {

enum class CpuIsa { kBaseline, kAvx2, kAvx512 };

/// "baseline", "avx2" or "avx512".
std::string_view cpuIsaName(CpuIsa isa);

/// Those that this build holds and this processor has, the best one last.
std::vector<CpuIsa> usableCpuIsas();
bool isUsable(CpuIsa isa);

/// The one named by the environment variable WEIR_CPU_ISA; the best usable one where that is not set or
/// empty. Throws a usage Error for a name that is unknown or not usable here.
CpuIsa chosenCpuIsa();

}  // namespace weir
