# For CPack, before it packs: puts the list of what is from elsewhere into the package (make_sbom.py).
find_program(python3 python3)
if(NOT python3)
  message(FATAL_ERROR "The package needs python3 for its list of parts (SBOM)")
endif()
execute_process(COMMAND ${python3} -B ${CMAKE_CURRENT_LIST_DIR}/make_sbom.py
                        ${CPACK_TEMPORARY_INSTALL_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX}
                        ${CMAKE_CURRENT_LIST_DIR}/../..
                COMMAND_ERROR_IS_FATAL ANY)
