# The digest of the interface forgets comments and blank lines, and nothing else: neither code nor headers that public
# ones include. A script: cmake -DROOT=… -P interface_digest.cmake
set(folder ${CMAKE_CURRENT_BINARY_DIR}/interface_digest_test)

function(digest_of public private out)
  file(REMOVE_RECURSE ${folder})
  file(WRITE ${folder}/include/weir/face.h "${public}")
  file(WRITE ${folder}/framework/inner.h "${private}")
  file(WRITE ${folder}/framework/unused.h "int unused();\n")
  execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${folder} -DVERSION=1 -DOUTPUT=${folder}/digest.h
                          -P ${ROOT}/cmake/WeirInterfaceDigest.cmake RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "the digest could not be made")
  endif()
  file(READ ${folder}/digest.h text)
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

set(face "#include \"framework/inner.h\"\nint face();\n")
digest_of("${face}" "struct Inner { int a\; }\;\n" before)
digest_of("// Another comment.\n\n${face}" "/* a\n * b */ struct Inner { int a\; }\;  // why\n" commented)
digest_of("${face}" "struct Inner { long a\; }\;\n" changed)
file(REMOVE_RECURSE ${folder})
if(NOT before STREQUAL commented)
  message(FATAL_ERROR "a comment changes the digest:\n${before}${commented}")
endif()
if(before STREQUAL changed)
  message(FATAL_ERROR "a member's type does not change the digest:\n${before}")
endif()
