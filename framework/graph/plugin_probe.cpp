#include "framework/graph/plugin_probe.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <new>
#include <string>

#include "framework/base/error.h"
#include "framework/base/forked_work.h"
#include "framework/base/text.h"

namespace weir {

namespace {

/// How the copy ends where a static object finds no memory.
constexpr int kNoMemory = 87;

/// Why loading ended the copy; "" if it did not.
std::string reasonOf(const ForkedEnd& end) {
  if (end.done) return {};
  if (end.outOfTime) return "its static objects do not come to an end when they are made";
  if (end.signal == 0)
    return "its static objects end the program when they are made, with exit code " +
           std::to_string(end.exitCode);
  constexpr std::size_t kLongest = 500;
  std::string said = end.bytes;
  std::replace(said.begin(), said.end(), '\n', ' ');
  return "its static objects cannot be made: " +
         (said.empty() ? "signal " + std::to_string(end.signal) : printable(said, kLongest));
}

}  // namespace

void probePlugin(const std::filesystem::path& file) {
  constexpr ForkedLimits kLimits{.cpuSeconds = 20, .seconds = 60, .keepsStderr = true};
  const std::string path = std::filesystem::absolute(file).string();
  const auto load = [&] {
    std::set_new_handler([] { ::_exit(kNoMemory); });
    dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    return std::string();
  };
  const ForkedEnd end = ForkedWork(load, kLimits).wait();
  if (!end.done && end.exitCode == kNoMemory) throw std::bad_alloc();
  const std::string reason = reasonOf(end);
  if (reason.empty()) return;
  throw ioError("the plugin cannot be loaded: " + reason, "static objects that need nothing and cannot fail")
      .at({.file = file.string()});
}

}  // namespace weir
