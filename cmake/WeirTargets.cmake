# How every library, program and test of this project is compiled.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CUDA_STANDARD 20)
set(CMAKE_CUDA_STANDARD_REQUIRED ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo)
endif()

# One layout for the build tree and an installation, so that the program finds its plugins in both.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(WEIR_PLUGIN_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/weir/plugins)

# Flags, include root and sanitizers of one target.
function(weir_configure_target target)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  # Designated initializers leave members out on purpose.
  set(warnings -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wno-missing-field-initializers)
  if(WEIR_WARNINGS_AS_ERRORS)
    list(APPEND warnings -Werror)
  endif()
  # GCC 12 sees overlapping copies in std::string's operator+ that are not there (GCC bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    list(APPEND warnings -Wno-restrict)
  endif()
  # Vectors wider than the processor's registers (framework/compute/lanes.h) only pass between inline functions,
  # so how they are passed does not matter.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND warnings -Wno-psabi)
  endif()
  # No contraction of a*b+c on the CPU: results must not depend on which instructions a build may use.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${warnings};-ffp-contract=off;-fno-math-errno>)
  if(WEIR_HAS_CUDA)
    # nvcc's host pass leaves copies of inline functions that the linker may choose, so it compiles alike.
    list(JOIN warnings "," cuda_warnings)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=${cuda_warnings},-ffp-contract=off,-fno-math-errno
                                             --expt-relaxed-constexpr --extended-lambda -lineinfo>)
    if(WEIR_WARNINGS_AS_ERRORS)
      target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings>)
    endif()
    target_link_libraries(${target} PRIVATE CUDA::cudart_static)
  endif()
  if(WEIR_SANITIZE)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=${WEIR_SANITIZE};-fno-omit-frame-pointer>)
    target_link_options(${target} PRIVATE -fsanitize=${WEIR_SANITIZE})
  endif()
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/../lib;$ORIGIN;$ORIGIN/../..")
endfunction()

# Adds the sources below `directory` to the target, by what their names say:
#   *.dual.cpp   compiled by the host compiler for the CPU, for each of its instruction sets (see WeirCpuIsas),
#                and again by nvcc for CUDA
#   *.cu         compiled by nvcc, in builds with CUDA
#   *.cpp        compiled by the host compiler
function(weir_add_sources target directory)
  file(GLOB_RECURSE host_sources CONFIGURE_DEPENDS ${directory}/*.cpp)
  file(GLOB_RECURSE dual_sources CONFIGURE_DEPENDS ${directory}/*.dual.cpp)
  file(GLOB_RECURSE cuda_sources CONFIGURE_DEPENDS ${directory}/*.cu)
  target_sources(${target} PRIVATE ${host_sources})
  foreach(isa ${WEIR_CPU_ISAS})
    foreach(source ${dual_sources})
      file(RELATIVE_PATH relative ${PROJECT_SOURCE_DIR} ${source})
      set(wrapper ${CMAKE_BINARY_DIR}/isa/${isa}/${relative})
      file(CONFIGURE OUTPUT ${wrapper} CONTENT "#include \"${source}\"\n" @ONLY)
      set_source_files_properties(${wrapper} PROPERTIES COMPILE_OPTIONS "${WEIR_CPU_ISA_OPTIONS_${isa}}")
      target_sources(${target} PRIVATE ${wrapper})
    endforeach()
  endforeach()
  if(WEIR_HAS_CUDA)
    target_sources(${target} PRIVATE ${cuda_sources})
    foreach(source ${dual_sources})
      file(RELATIVE_PATH relative ${PROJECT_SOURCE_DIR} ${source})
      set(wrapper ${CMAKE_BINARY_DIR}/dual/${relative}.cu)
      file(CONFIGURE OUTPUT ${wrapper} CONTENT "#include \"${source}\"\n" @ONLY)
      target_sources(${target} PRIVATE ${wrapper})
    endforeach()
  endif()
endfunction()

# A shared library that the program loads at run time. Arguments: name, then the libraries it links.
function(weir_add_plugin name)
  add_library(weir_${name} MODULE)
  weir_configure_target(weir_${name})
  weir_add_sources(weir_${name} ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(weir_${name} PRIVATE weir::nodes ${ARGN})
  set_target_properties(weir_${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${WEIR_PLUGIN_OUTPUT_DIRECTORY}
                                                PREFIX "" OUTPUT_NAME weir_${name})
  set_property(GLOBAL APPEND PROPERTY WEIR_PLUGINS ${name})
  install(TARGETS weir_${name} LIBRARY DESTINATION lib/weir/plugins)
endfunction()

# A room's test program. Arguments: name, its directory below tests/, then the libraries it links.
function(weir_add_tests name directory)
  add_executable(weir_${name}_tests)
  weir_configure_target(weir_${name}_tests)
  weir_add_sources(weir_${name}_tests ${CMAKE_CURRENT_SOURCE_DIR}/${directory})
  target_link_libraries(weir_${name}_tests PRIVATE ${ARGN} GTest::gtest GTest::gtest_main)
  gtest_discover_tests(weir_${name}_tests TEST_PREFIX ${name}/ DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 900)
endfunction()
