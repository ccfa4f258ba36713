#include "framework/compute/cpu_isa.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "framework/base/error.h"
#include "framework/base/value.h"

namespace weir {

namespace {

constexpr const char* kVariable = "WEIR_CPU_ISA";

bool processorHas(CpuIsa isa) {
  switch (isa) {
    case CpuIsa::kBaseline:
      return true;
      // These ask the operating system, too, whether it keeps the wide registers.
#ifdef WEIR_HAS_AVX2
    case CpuIsa::kAvx2:
      return __builtin_cpu_supports("x86-64-v3");
#endif
#ifdef WEIR_HAS_AVX512
    case CpuIsa::kAvx512:
      return __builtin_cpu_supports("x86-64-v4");
#endif
    default:
      return false;
  }
}

}  // namespace

std::string_view cpuIsaName(CpuIsa isa) {
  switch (isa) {
    case CpuIsa::kAvx2:
      return "avx2";
    case CpuIsa::kAvx512:
      return "avx512";
    default:
      return "baseline";
  }
}

std::vector<CpuIsa> usableCpuIsas() {
  std::vector<CpuIsa> usable;
  for (const CpuIsa isa : {CpuIsa::kBaseline, CpuIsa::kAvx2, CpuIsa::kAvx512}) {
    if (processorHas(isa)) usable.push_back(isa);
  }
  return usable;
}

bool isUsable(CpuIsa isa) {
  return processorHas(isa);
}

CpuIsa chosenCpuIsa() {
  const std::vector<CpuIsa> usable = usableCpuIsas();
  const char* told = std::getenv(kVariable);
  if (told == nullptr || *told == '\0') return usable.back();
  for (const CpuIsa isa : usable) {
    if (told == cpuIsaName(isa)) return isa;
  }
  std::vector<std::string> names;
  for (const CpuIsa isa : usable) names.emplace_back(cpuIsaName(isa));
  throw usageError(fmt::format("the environment variable {} is '{}'", kVariable, told),
                   joinNames(names) + ", which this build and this processor have");
}

}  // namespace weir
