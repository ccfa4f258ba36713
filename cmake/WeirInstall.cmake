# What an installation holds beside programs and libraries: the public headers, with what they include below
# include/weir/detail, the CMake package, scenes, meshes, and the template of `weir new-plugin`. Everything finds everything else by relative
# paths, so the tree can be moved.
include(CMakePackageConfigHelpers)

set(weir_package lib/cmake/Weir)
weir_public_headers(${PROJECT_SOURCE_DIR} weir_headers)
foreach(header ${weir_headers})
  get_filename_component(folder ${header} DIRECTORY)
  if(folder STREQUAL "include/weir")
    install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION include/weir)
  else()
    install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION include/weir/detail/${folder})
  endif()
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/framework/graph/interface_digest.h
        DESTINATION include/weir/detail/framework/graph)
# The CUDA runtime goes along, as drivers do not bring it. In the build tree it is linked to.
if(WEIR_HAS_CUDA)
  file(REAL_PATH ${CUDA_CUDART} weir_cudart)
  execute_process(COMMAND ${CMAKE_READELF} -d ${weir_cudart} OUTPUT_VARIABLE weir_cudart_name ERROR_QUIET)
  if(NOT weir_cudart_name MATCHES "SONAME[^[]*\\[(libcudart[^]]+)\\]")
    message(FATAL_ERROR "CUDA_CUDART must be the shared CUDA runtime, libcudart.so, and is ${CUDA_CUDART}")
  endif()
  set(weir_cudart_name ${CMAKE_MATCH_1})
  install(FILES ${weir_cudart} DESTINATION lib/weir/bundled RENAME ${weir_cudart_name})
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/lib/weir/bundled)
  file(CREATE_LINK ${weir_cudart} ${PROJECT_BINARY_DIR}/lib/weir/bundled/${weir_cudart_name} SYMBOLIC)
  # Its licence, from a toolkit or from the package of PyPI.
  get_filename_component(weir_cudart_folder ${weir_cudart} DIRECTORY)
  file(GLOB weir_cudart_licence ${weir_cudart_folder}/../../../nvidia_cuda_runtime-*.dist-info/licenses/License.txt
       ${CUDAToolkit_TARGET_DIR}/EULA.txt ${CUDAToolkit_ROOT_DIR}/EULA.txt ${CUDAToolkit_BIN_DIR}/../EULA.txt)
  if(weir_cudart_licence)
    list(GET weir_cudart_licence 0 weir_cudart_licence)
    install(FILES ${weir_cudart_licence} DESTINATION share/doc/weir/bundled RENAME cuda-runtime.txt)
  endif()
endif()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/resources/scenes ${PROJECT_SOURCE_DIR}/resources/meshes
                  ${PROJECT_SOURCE_DIR}/resources/templates
        DESTINATION share/weir)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/tools/paraview DESTINATION share/weir FILES_MATCHING PATTERN "*.py")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md DESTINATION share/doc/weir)

# Configured at once, so that a change of this file needs no thought of when it is installed.
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/WeirConfig.cmake.in ${PROJECT_BINARY_DIR}/WeirConfig.cmake
                              INSTALL_DESTINATION ${weir_package} NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/WeirConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/WeirConfig.cmake ${PROJECT_BINARY_DIR}/WeirConfigVersion.cmake
              cmake/WeirCompile.cmake cmake/WeirCpuIsas.cmake cmake/WeirCuda.cmake cmake/standard_headers.h
        DESTINATION ${weir_package})
install(EXPORT Weir NAMESPACE Weir:: FILE WeirTargets.cmake DESTINATION ${weir_package})

# The build tree is laid out alike.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/weir)
foreach(folder scenes meshes templates)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/resources/${folder} ${PROJECT_BINARY_DIR}/share/weir/${folder} SYMBOLIC)
endforeach()
