# Decides for which instruction sets, beside those of the whole build, the kernels of the CPU are compiled.
#
# Sets WEIR_CPU_ISAS and for each of them WEIR_CPU_ISA_OPTIONS_<isa>; where there is nothing to choose (other
# processors, other compilers), WEIR_CPU_ISAS is empty and WEIR_CPU_ISAS_REASON says why.
#
# An inline function of a header that is compiled with such options must not become the one that the linker
# keeps for everybody, or programs would die on processors without them. -fno-weak, which only GCC has, makes
# all inline functions and templates of such a source local to it. It warns of every inline constant, which then
# has several copies; -w, because warnings that matter come from the baseline's compilation of the same source.

set(WEIR_CPU_ISAS "")
set(WEIR_CPU_ISAS_REASON "")
if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
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
  if(WEIR_COMPILER_HAS_CPU_ISAS)
    set(WEIR_CPU_ISAS avx2 avx512)
    set(WEIR_CPU_ISA_OPTIONS_avx2 -march=x86-64-v3 -fno-weak -w -DWEIR_FOR_AVX2)
    # GCC 12.2 gets loops over the doubles of bodies wrong where it makes them 512 bits wide.
    set(WEIR_CPU_ISA_OPTIONS_avx512 -march=x86-64-v4 -mprefer-vector-width=256 -fno-weak -w -DWEIR_FOR_AVX512)
  else()
    set(WEIR_CPU_ISAS_REASON "WEIR_COMPILER_HAS_CPU_ISAS is off, or this GCC does not know x86-64-v4")
  endif()
endif()
