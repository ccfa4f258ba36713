# Writes a header with a digest of all headers that plugins may include, so that the host can refuse a plugin that
# was compiled against others. A script: cmake -DROOT=… -DVERSION=… -DOUTPUT=… -P WeirInterfaceDigest.cmake

file(GLOB_RECURSE headers RELATIVE ${ROOT} ${ROOT}/framework/*.h ${ROOT}/framework/*.inl ${ROOT}/nodes/*.h
     ${ROOT}/nodes/*.inl)
list(SORT headers)
set(all "")
foreach(header ${headers})
  file(SHA256 ${ROOT}/${header} digest)
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
