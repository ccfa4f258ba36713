# Decides whether the CUDA back end is built, enables the language, and says why not where it is not.
#
# Sets WEIR_HAS_CUDA. Accepts a toolkit on PATH, in CUDACXX or CMAKE_CUDA_COMPILER, in /usr/local/cuda, and
# the compiler from PyPI (see docs/building.md), whose libraries stand in lib/ and not in lib64/.

set(WEIR_HAS_CUDA OFF)
if(WEIR_CUDA STREQUAL "OFF")
  set(WEIR_CUDA_REASON "switched off by WEIR_CUDA=OFF")
  return()
endif()

if(NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
  find_program(WEIR_NVCC nvcc HINTS /usr/local/cuda/bin)
  if(WEIR_NVCC)
    set(CMAKE_CUDA_COMPILER ${WEIR_NVCC})
  endif()
endif()

if(NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
  set(WEIR_CUDA_REASON "no nvcc on PATH, in CUDACXX or in /usr/local/cuda/bin")
  if(WEIR_CUDA STREQUAL "ON")
    message(FATAL_ERROR "WEIR_CUDA=ON, but there is no CUDA compiler: ${WEIR_CUDA_REASON}.\n"
                        "Set CMAKE_CUDA_COMPILER to nvcc, or run ./dev setup-cuda to install one from PyPI.")
  endif()
  return()
endif()

if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
  set(CMAKE_CUDA_ARCHITECTURES 75 80 86 89 90)
endif()

# The compiler from PyPI does not look into its own lib/, so the check of the language cannot link cudadevrt.
if(CMAKE_CUDA_COMPILER)
  get_filename_component(weir_cuda_bin ${CMAKE_CUDA_COMPILER} DIRECTORY)
  get_filename_component(weir_cuda_root ${weir_cuda_bin} DIRECTORY)
  if(EXISTS ${weir_cuda_root}/lib/libcudart_static.a)
    string(APPEND CMAKE_CUDA_FLAGS " -L${weir_cuda_root}/lib")
    file(GLOB weir_cudart ${weir_cuda_root}/lib/libcudart.so.*)
    if(weir_cudart)
      list(GET weir_cudart 0 weir_cudart)
      set(CUDA_CUDART ${weir_cudart} CACHE FILEPATH "CUDA runtime library")
      # It comes without the name libcudart.so, so CMake looked in vain.
      if(NOT CUDA_cudart_LIBRARY)
        set(CUDA_cudart_LIBRARY ${weir_cudart} CACHE FILEPATH "CUDA runtime library" FORCE)
      endif()
    endif()
  endif()
endif()

enable_language(CUDA)
# CMake 3.25 does not know that CUDA 13 speaks C++20.
if(NOT CMAKE_CUDA20_STANDARD_COMPILE_OPTION)
  set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
  set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
endif()
find_package(CUDAToolkit REQUIRED)
set(WEIR_HAS_CUDA ON)
