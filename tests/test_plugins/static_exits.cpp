// Its static object ends the program while the library is loaded.
#include <cstdlib>

#include <weir/plugin.h>

namespace {

struct Exits {
  Exits() { std::_Exit(3); }
};

const Exits exits;

}  // namespace

WEIR_PLUGIN("static_exits", "Ends the program when it is loaded.", registry) {
  (void)registry;
}
