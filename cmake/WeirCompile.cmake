# How libraries, plugins and tests are compiled: in this project, and in others that build against an installed
# Weir, where find_package(Weir) includes this file. Needs WeirCuda and WeirCpuIsas to be included before.

# Where weir_add_plugin() puts libraries. Name it in WEIR_PLUGIN_PATH to run a plugin from there.
if(NOT WEIR_PLUGIN_OUTPUT_DIRECTORY)
  set(WEIR_PLUGIN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/plugins)
endif()

option(WEIR_HARDENING "Build with stack protection, checked memory functions and read-only relocations" ON)
set(WEIR_FORTIFY_LEVEL 3)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 12)
  set(WEIR_FORTIFY_LEVEL 2)
endif()

# Of no use with a compiler cache, which finds less in it.
option(WEIR_PRECOMPILED_HEADERS "Compile headers of the standard library once, and once for each instruction set" OFF)
set(WEIR_STANDARD_HEADERS ${CMAKE_CURRENT_LIST_DIR}/standard_headers.h)

# Flags, include root and sanitizers of one target.
function(weir_configure_target target)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  set_target_properties(${target} PROPERTIES CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF
                                             CUDA_STANDARD 20 CUDA_STANDARD_REQUIRED ON)
  # A library exports what headers for other libraries declare: these open their namespace with visibility "default".
  # Clang asks the namespace around the definition instead, so what it builds exports everything.
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden CUDA_VISIBILITY_PRESET hidden
                                               VISIBILITY_INLINES_HIDDEN ON)
  endif()
  # Designated initializers leave members out on purpose.
  set(warnings -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wno-missing-field-initializers)
  if(WEIR_WARNINGS_AS_ERRORS)
    list(APPEND warnings -Werror)
  endif()
  # GCC 12 sees overlapping copies in std::string's operator+ that are not there (GCC bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    list(APPEND warnings -Wno-restrict)
    if(WEIR_PRECOMPILED_HEADERS)
      list(APPEND warnings -Wno-stringop-overflow -Wno-stringop-overread)
    endif()
  endif()
  # Vectors wider than the processor's registers (framework/compute/lanes.h) only pass between inline functions,
  # so how they are passed does not matter.
  list(APPEND warnings -Wno-psabi)
  # What a kernel says of itself to CUDA (framework/compute/standing.h) has no reader on the CPU.
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    list(APPEND warnings -Wno-unused-const-variable)
  endif()
  # No contraction of a*b+c on the CPU: results must not depend on which instructions a build may use.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${warnings};-ffp-contract=off;-fno-math-errno>)
  # Which kernels the target holds decides what `dispatch` may choose from, so it is no property of the libraries
  # that it links.
  foreach(isa ${WEIR_CPU_ISAS})
    string(TOUPPER ${isa} isa)
    target_compile_definitions(${target} PRIVATE WEIR_HAS_${isa})
  endforeach()
  if(WEIR_HAS_CUDA)
    target_compile_definitions(${target} PRIVATE WEIR_HAS_CUDA)
    # nvcc's host pass leaves copies of inline functions that the linker may choose, so it compiles alike.
    list(JOIN warnings "," cuda_warnings)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=${cuda_warnings},-ffp-contract=off,-fno-math-errno
                                             --expt-relaxed-constexpr --extended-lambda -lineinfo>)
    if(WEIR_WARNINGS_AS_ERRORS)
      target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings>)
    endif()
    # One runtime for all libraries of a process: it knows the kernels of each, and their streams and memory.
    set_target_properties(${target} PROPERTIES CUDA_RUNTIME_LIBRARY None)
    target_link_libraries(${target} PRIVATE CUDA::cudart)
  endif()
  if(WEIR_SANITIZE)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=${WEIR_SANITIZE};-fno-omit-frame-pointer;-fno-sanitize-recover=all>)
    target_link_options(${target} PRIVATE -fsanitize=${WEIR_SANITIZE})
  endif()
  # The old kind of run path (DT_RPATH) also serves the libraries that the named ones need in turn, so a folder of
  # libraries that were built elsewhere works wherever it is moved.
  target_link_options(${target} PRIVATE -Wl,--disable-new-dtags)
  # From bin/, lib/ or lib/weir/plugins; a tarball brings the libraries of others in lib/weir/bundled.
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "EXECUTABLE")
    set(run_path "$ORIGIN/../lib;$ORIGIN/../lib/weir/bundled")
  elseif(type STREQUAL "MODULE_LIBRARY")
    set(run_path "$ORIGIN/../..;$ORIGIN/../bundled")
  else()
    set(run_path "$ORIGIN;$ORIGIN/weir/bundled")
  endif()
  weir_set_run_path(${target} "${run_path}")
  weir_harden(${target})
endfunction()

# Where a target finds its libraries, in the build tree as where it is installed: CMake ends a path that it would
# replace by another with colons, and the loader takes the empty entries behind them for the current folder.
function(weir_set_run_path target run_path)
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "${run_path}" BUILD_WITH_INSTALL_RPATH ON
                                             INSTALL_RPATH_USE_LINK_PATH ON)
endfunction()

# What makes mistakes in memory harder to use against a user. Overflow checks of the C library need an optimised
# build, and sanitizers have their own.
function(weir_harden target)
  if(NOT WEIR_HARDENING OR WEIR_SANITIZE)
    return()
  endif()
  set(optimised $<CONFIG:Release,RelWithDebInfo,MinSizeRel>)
  # Not for CUDA: nvcc's parser does not know what the C library's level 3 is made of.
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CXX>:-fstack-protector-strong> $<$<COMPILE_LANGUAGE:CUDA>:-Xcompiler=-fstack-protector-strong>
    $<$<AND:$<COMPILE_LANGUAGE:CXX>,${optimised}>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=${WEIR_FORTIFY_LEVEL}>)
  target_link_options(${target} PRIVATE -Wl,-z,relro -Wl,-z,now)
endfunction()

# A target that compiles the standard headers, with further options of the compiler: what is compiled with the same may
# use them.
function(weir_precompile_standard_headers target)
  if(TARGET ${target})
    return()
  endif()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${target}.cpp CONTENT "")
  add_library(${target} OBJECT ${PROJECT_BINARY_DIR}/${target}.cpp)
  weir_configure_target(${target})
  target_compile_options(${target} PRIVATE ${ARGN})
  target_precompile_headers(${target} PRIVATE ${WEIR_STANDARD_HEADERS})
endfunction()

# Adds the sources below `directory` to the target, by what their names say:
#   *.dual.cpp   compiled by the host compiler for the CPU, for each of its instruction sets (see WeirCpuIsas),
#                and again by nvcc for CUDA
#   *.cu         compiled by nvcc, in builds with CUDA
#   *.cpp        compiled by the host compiler
function(weir_add_sources target directory)
  file(GLOB_RECURSE host_sources CONFIGURE_DEPENDS ${directory}/*.cpp)
  file(GLOB_RECURSE cuda_sources CONFIGURE_DEPENDS ${directory}/*.cu)
  weir_add_source_files(${target} ${host_sources} ${cuda_sources})
endfunction()

# The same for files, given by their full paths.
function(weir_add_source_files target)
  set(host_sources ${ARGN})
  list(FILTER host_sources INCLUDE REGEX "\\.cpp$")
  set(dual_sources ${ARGN})
  list(FILTER dual_sources INCLUDE REGEX "\\.dual\\.cpp$")
  set(cuda_sources ${ARGN})
  list(FILTER cuda_sources INCLUDE REGEX "\\.cu$")
  target_sources(${target} PRIVATE ${host_sources})
  get_target_property(type ${target} TYPE)
  if(WEIR_PRECOMPILED_HEADERS AND NOT type STREQUAL "EXECUTABLE")  # programs are compiled as -fPIE
    weir_precompile_standard_headers(weir_standard_headers)
    target_precompile_headers(${target} REUSE_FROM weir_standard_headers)
  endif()
  foreach(isa ${WEIR_CPU_ISAS})
    set(options ${WEIR_CPU_ISA_OPTIONS_${isa}})
    if(WEIR_PRECOMPILED_HEADERS AND dual_sources)
      weir_precompile_standard_headers(weir_standard_headers_${isa} ${options})
      get_target_property(headers weir_standard_headers_${isa} BINARY_DIR)
      string(APPEND headers /CMakeFiles/weir_standard_headers_${isa}.dir/cmake_pch.hxx)
      list(APPEND options -include ${headers})
    endif()
    foreach(source ${dual_sources})
      file(RELATIVE_PATH relative ${PROJECT_SOURCE_DIR} ${source})
      set(wrapper ${PROJECT_BINARY_DIR}/isa/${isa}/${relative})
      file(CONFIGURE OUTPUT ${wrapper} CONTENT "#include \"${source}\"\n" @ONLY)
      set_source_files_properties(${wrapper} PROPERTIES COMPILE_OPTIONS "${options}" SKIP_PRECOMPILE_HEADERS ON)
      if(WEIR_PRECOMPILED_HEADERS)
        set_source_files_properties(${wrapper} PROPERTIES OBJECT_DEPENDS ${headers}.gch)
      endif()
      target_sources(${target} PRIVATE ${wrapper})
    endforeach()
  endforeach()
  if(WEIR_HAS_CUDA)
    target_sources(${target} PRIVATE ${cuda_sources})
    foreach(source ${dual_sources})
      file(RELATIVE_PATH relative ${PROJECT_SOURCE_DIR} ${source})
      set(wrapper ${PROJECT_BINARY_DIR}/dual/${relative}.cu)
      file(CONFIGURE OUTPUT ${wrapper} CONTENT "#include \"${source}\"\n" @ONLY)
      target_sources(${target} PRIVATE ${wrapper})
    endforeach()
  endif()
endfunction()

# A library that the program loads at run time, of all sources in the current folder and below its folder src:
# target and file are called weir_NAME.
#
#   weir_add_plugin(NAME [LIBRARY...])
#
# LIBRARY... are linked beside Weir's own. `cmake --install` puts it below <prefix>/lib/weir/plugins, where a Weir
# that is installed in the same prefix finds it.
function(weir_add_plugin name)
  # Not all that is below, as that may hold tests and a build folder.
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp ${CMAKE_CURRENT_SOURCE_DIR}/*.cu)
  file(GLOB_RECURSE more_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cpp
       ${CMAKE_CURRENT_SOURCE_DIR}/src/*.cu)
  add_library(weir_${name} MODULE)
  weir_configure_target(weir_${name})
  weir_add_source_files(weir_${name} ${sources} ${more_sources})
  target_link_libraries(weir_${name} PRIVATE Weir::nodes ${ARGN})
  set_target_properties(weir_${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${WEIR_PLUGIN_OUTPUT_DIRECTORY}
                                                PREFIX "" OUTPUT_NAME weir_${name})
  set_property(GLOBAL APPEND PROPERTY WEIR_PLUGINS ${name})
  install(TARGETS weir_${name} LIBRARY DESTINATION lib/weir/plugins)
endfunction()
