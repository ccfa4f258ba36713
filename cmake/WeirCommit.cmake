# A script: writes RESULT from TEMPLATE with the commit of the folder SOURCE, followed by "-changed" where files
# that git knows differ from it; GIVEN where that is set (-DWEIR_COMMIT=…, for sources that were unpacked);
# "unknown" where SOURCE is no repository of its own.
set(commit "${GIVEN}")
if(commit STREQUAL "")
  set(commit unknown)
  find_program(git git)
  if(git)
    execute_process(COMMAND ${git} -C ${SOURCE} rev-parse --show-toplevel OUTPUT_VARIABLE top
                    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    execute_process(COMMAND ${git} -C ${SOURCE} describe --always --abbrev=7 --exclude=* --dirty=-changed
                    OUTPUT_VARIABLE described RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    file(REAL_PATH "${SOURCE}" source)  # as git has it
    if(top STREQUAL source AND NOT failed)
      set(commit "${described}")
    endif()
  endif()
endif()
configure_file(${TEMPLATE} ${RESULT} @ONLY)
