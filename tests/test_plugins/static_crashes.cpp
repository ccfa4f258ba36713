// Its static object crashes while the library is loaded.
#include <csignal>

#include <weir/plugin.h>

namespace {

struct Crashes {
  Crashes() { std::raise(SIGSEGV); }
};

const Crashes crashes;

}  // namespace

WEIR_PLUGIN("static_crashes", "Crashes when it is loaded.", registry) {
  (void)registry;
}
