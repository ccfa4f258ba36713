# The .deb, made by CPack: `cpack --config build/cpu/CPackConfig.cmake`, or ./dev package. Libraries are those of the
# system that it was made on, and become dependencies.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME weir)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The developers of Weir")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Node-graph simulation of liquids on CPUs and CUDA")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/lib)
# Pictures are drawn by the system's OpenGL and coded by its ffmpeg; plugins need a compiler.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "ffmpeg, libegl1, libgl1-mesa-dri")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, ninja-build")
include(CPack)
