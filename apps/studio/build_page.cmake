# Builds the studio's page: cmake -DNPM=… -DWEB=… -DWORK=… -DPAGE=… -P build_page.cmake. The packages that it needs are
# fetched when their list has changed. Without a network the page is left out, and all else is built.
file(MAKE_DIRECTORY ${WORK})
set(wanted ${WEB}/package-lock.json)
set(fetched ${WORK}/node_modules/fetched-for.json)
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${wanted} ${fetched} RESULT_VARIABLE changed ERROR_QUIET)
file(COPY ${WEB}/package.json ${wanted} DESTINATION ${WORK})
if(changed)
  execute_process(COMMAND ${NPM} ci --no-audit --no-fund --loglevel=error WORKING_DIRECTORY ${WORK} RESULT_VARIABLE failed)
  if(failed)
    message(WARNING "npm cannot fetch the packages of the studio's page, so it is left out: 'weir studio' will say so")
    return()
  endif()
  configure_file(${wanted} ${fetched} COPYONLY)
endif()
file(REMOVE_RECURSE ${WORK}/src ${WORK}/public ${WORK}/test ${WORK}/browser)
file(COPY ${WEB}/src ${WEB}/public ${WEB}/test ${WEB}/browser ${WEB}/index.html ${WEB}/tsconfig.json ${WEB}/vite.config.ts DESTINATION ${WORK})
execute_process(COMMAND ${NPM} run --silent build -- --outDir ${PAGE} --emptyOutDir --logLevel warn
                WORKING_DIRECTORY ${WORK} COMMAND_ERROR_IS_FATAL ANY)
