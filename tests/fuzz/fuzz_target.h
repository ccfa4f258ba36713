// What the targets of libFuzzer share: bytes in, and an Error or a value out; all else is a finding.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

#include "framework/base/error.h"

namespace weir::fuzz {

/// Calls f with the bytes as text. An Error is as good an end as any (WEIR_FUZZ_SHOW=1 prints it); other
/// exceptions and crashes are not.
template <class F>
int withText(const std::uint8_t* data, std::size_t size, F&& f) {
  try {
    f(std::string_view(reinterpret_cast<const char*>(data), size));
  } catch (const Error& e) {
    if (e.message().empty()) std::abort();
    if (std::getenv("WEIR_FUZZ_SHOW") != nullptr) std::puts(e.what());
  }
  return 0;
}

/// The same with a file of these bytes, in memory where there is one (/dev/shm).
template <class F>
int withFile(const std::uint8_t* data, std::size_t size, const char* ending, F&& f) {
  static const std::string file = (::access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp") +
                                  std::string("/weir_fuzz_") + std::to_string(::getpid()) + ending;
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  static const int atEnd = std::atexit([] { ::unlink(file.c_str()); });
  static_cast<void>(atEnd);
  return withText(data, size, [&](std::string_view) { f(file); });
}

}  // namespace weir::fuzz
