# Writes a header with a digest of all headers that plugins may include, so that the host can refuse a plugin that
# was compiled against others. Comments and blank lines do not count. A script:
# cmake -DROOT=… -DVERSION=… -DOUTPUT=… -P WeirInterfaceDigest.cmake

include(${CMAKE_CURRENT_LIST_DIR}/WeirPublicHeaders.cmake)
weir_public_headers(${ROOT} headers)
set(all "")
foreach(header ${headers})
  file(READ ${ROOT}/${header} text)
  string(REGEX REPLACE "/\\*([^*]|\\*+[^*/])*\\*+/" " " text "${text}")
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REGEX REPLACE "[ \t\n]+" " " text "${text}")
  string(STRIP "${text}" text)
  string(SHA256 digest "${text}")
  string(APPEND all "${header} ${digest}\n")
endforeach()
string(SHA256 digest "${all}")
string(SUBSTRING ${digest} 0 16 digest)

file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
// Written by the build: which headers a library was compiled against.
#pragma once

namespace weir {

inline constexpr char kInterfaceIdentity[] = "@VERSION@, headers @digest@";

}  // namespace weir
]])
