#include "apps/weir/program_file.h"

#include <sys/auxv.h>

#include <system_error>

namespace weir::app {

namespace fs = std::filesystem;

fs::path programFile() {
  std::error_code error;
  fs::path executable = fs::read_symlink("/proc/self/exe", error);
  // Where /proc is not mounted, as in some containers: the path that the program was started by.
  if (error) executable = fs::canonical(reinterpret_cast<const char*>(getauxval(AT_EXECFN)), error);
  return executable;
}

}  // namespace weir::app
