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
include(WeirCompile)

# A room's test program. Arguments: name, its directory below tests/, then the libraries it links.
function(weir_add_tests name directory)
  add_executable(weir_${name}_tests)
  weir_configure_target(weir_${name}_tests)
  weir_add_sources(weir_${name}_tests ${CMAKE_CURRENT_SOURCE_DIR}/${directory})
  target_link_libraries(weir_${name}_tests PRIVATE ${ARGN} GTest::gtest GTest::gtest_main)
  # A test is compiled more often than it runs: what it tests is in the libraries, as fast as it is for users.
  set(optimised $<IF:$<CONFIG:Release>,-O1,>)
  if(WEIR_SANITIZE)
    set(optimised -O0)
  endif()
  target_compile_options(weir_${name}_tests PRIVATE $<$<COMPILE_LANGUAGE:CXX>:${optimised}>)
  target_precompile_headers(weir_${name}_tests PRIVATE
    "$<$<COMPILE_LANGUAGE:CXX>:${PROJECT_SOURCE_DIR}/tests/support/precompiled.h>")
  # `ctest -L fast` leaves out those of tests/slow_tests.txt.
  file(STRINGS ${CMAKE_CURRENT_SOURCE_DIR}/slow_tests.txt slow REGEX "^[^#]")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/slow_tests.txt)
  list(JOIN slow ":" slow)
  gtest_discover_tests(weir_${name}_tests TEST_PREFIX ${name}/ TEST_FILTER "-${slow}" TEST_LIST ${name}_fast_tests
                       DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 900 LABELS fast)
  gtest_discover_tests(weir_${name}_tests TEST_PREFIX ${name}/ TEST_FILTER "${slow}" TEST_LIST ${name}_slow_tests
                       DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 900)
endfunction()
