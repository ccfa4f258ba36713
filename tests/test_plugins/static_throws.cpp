// Its static object throws while the library is loaded, before anyone can ask what it is.
#include <stdexcept>

#include <weir/plugin.h>

namespace {

struct NeedsLicence {
  NeedsLicence() { throw std::runtime_error("no licence found"); }
};

const NeedsLicence licence;

}  // namespace

WEIR_PLUGIN("static_throws", "Throws when it is loaded.", registry) {
  (void)registry;
}
