#include "apps/weir/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "framework/base/error.h"

namespace weir::app {

namespace {

[[noreturn]] void cannotPrint(int error) {
  throw ioError("standard output cannot be written" +
                (error != 0 ? ": " + std::generic_category().message(error) : std::string()));
}

}  // namespace

void openStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    // open() takes the lowest number that is free: this one.
    if (::open("/dev/null", stream == STDIN_FILENO ? O_RDONLY : O_WRONLY) < 0) return;
  }
}

void print(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) cannotPrint(errno);
}

void finishPrinting() {
  errno = 0;
  if (std::fflush(stdout) != 0) cannotPrint(errno);
  if (std::ferror(stdout) != 0) cannotPrint(0);
}

}  // namespace weir::app
