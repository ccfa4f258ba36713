# Decides for which instruction sets, beside those of the whole build, the kernels of the CPU are compiled.
#
# WEIR_CPU_KERNELS: all (AVX2 and AVX-512), native (the best of them that this machine has) or baseline (none).
#
# Sets WEIR_CPU_ISAS and for each of them WEIR_CPU_ISA_OPTIONS_<isa>; where there is nothing to choose (other
# processors, other compilers), WEIR_CPU_ISAS is empty and WEIR_CPU_ISAS_REASON says why.
#
# An inline function of a header that is compiled with such options must not become the one that the linker
# keeps for everybody, or programs would die on processors without them. -fno-weak, which only GCC has, makes
# all inline functions and templates of such a source local to it. It warns of every inline constant, which then
# has several copies; -w, because warnings that matter come from the baseline's compilation of the same source.

set(WEIR_CPU_KERNELS all CACHE STRING "Kernels of the CPU beside the baseline's: all, native (for this machine) or baseline (none)")
set_property(CACHE WEIR_CPU_KERNELS PROPERTY STRINGS all native baseline)

set(WEIR_CPU_ISA_OPTIONS_avx2 -march=x86-64-v3 -fno-weak -w -DWEIR_FOR_AVX2)
# GCC 12.2 gets loops over the doubles of bodies wrong where it makes them 512 bits wide.
set(WEIR_CPU_ISA_OPTIONS_avx512 -march=x86-64-v4 -mprefer-vector-width=256 -fno-weak -w -DWEIR_FOR_AVX512)

# Sets `result` to avx512 or avx2, the best that the processor of this machine has, or to nothing.
function(weir_find_native_isa result)
  include(CheckCXXSourceRuns)
  set(level_of_avx2 3)
  set(level_of_avx512 4)
  set(best "")
  foreach(isa avx2 avx512)
    set(level x86-64-v${level_of_${isa}})
    check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"${level}\") ? 0 : 1; }" WEIR_PROCESSOR_HAS_${isa})
    if(WEIR_PROCESSOR_HAS_${isa})
      set(best ${isa})
    endif()
  endforeach()
  set(${result} "${best}" PARENT_SCOPE)
endfunction()

set(WEIR_CPU_ISAS "")
set(WEIR_CPU_ISAS_REASON "")
if(NOT WEIR_CPU_KERNELS MATCHES "^(all|native|baseline)$")
  message(FATAL_ERROR "WEIR_CPU_KERNELS is '${WEIR_CPU_KERNELS}', and may be all, native or baseline")
elseif(WEIR_CPU_KERNELS STREQUAL "baseline")
  set(WEIR_CPU_ISAS_REASON "WEIR_CPU_KERNELS says so")
elseif(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(WEIR_CPU_ISAS_REASON "others are for x86-64, and this is ${CMAKE_SYSTEM_PROCESSOR}")
elseif(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(WEIR_CPU_ISAS_REASON "only GCC keeps kernels for AVX2 and AVX-512 apart (-fno-weak): a build by GCC is faster")
else()
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_FLAGS "-march=x86-64-v4 -fno-weak")
  check_cxx_source_compiles(
    "int main() { return __builtin_cpu_supports(\"x86-64-v3\") + __builtin_cpu_supports(\"x86-64-v4\"); }"
    WEIR_COMPILER_HAS_CPU_ISAS)
  unset(CMAKE_REQUIRED_FLAGS)
  if(NOT WEIR_COMPILER_HAS_CPU_ISAS)
    set(WEIR_CPU_ISAS_REASON "this GCC does not know x86-64-v4")
  elseif(WEIR_CPU_KERNELS STREQUAL "native" AND NOT CMAKE_CROSSCOMPILING)
    weir_find_native_isa(WEIR_CPU_ISAS)
    set(WEIR_CPU_ISAS_REASON "this processor has no AVX2")
  else()
    set(WEIR_CPU_ISAS avx2 avx512)
  endif()
endif()
