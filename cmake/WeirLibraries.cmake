# The libraries that nothing goes without. All that are missing are named at once, with the packages that bring them.
set(weir_missing_libraries "")
set(weir_missing_packages "")

macro(weir_need name package) # then the version and other arguments of find_package
  find_package(${name} ${ARGN} QUIET)
  if(NOT ${name}_FOUND)
    list(APPEND weir_missing_libraries "${name}")
    list(APPEND weir_missing_packages "${package}")
  endif()
endmacro()

weir_need(Eigen3 libeigen3-dev 3.3 NO_MODULE)
weir_need(TBB libtbb-dev)
weir_need(fmt libfmt-dev)
weir_need(spdlog libspdlog-dev)
weir_need(nlohmann_json nlohmann-json3-dev 3.10)
weir_need(CLI11 libcli11-dev)
weir_need(ZLIB zlib1g-dev)
find_package(Threads REQUIRED)

if(weir_missing_libraries)
  list(JOIN weir_missing_libraries ", " libraries)
  list(JOIN weir_missing_packages " " packages)
  message(FATAL_ERROR "Weir needs libraries that were not found, or only in versions that are too old: ${libraries}.\n"
                      "  On Debian and Ubuntu: apt-get install ${packages}\n"
                      "  or ./dev setup, which installs all that Weir can use; docs/building.md lists it.\n")
endif()
