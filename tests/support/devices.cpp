#include "tests/support/devices.h"

#include <cstdio>
#include <cstdlib>
#include <sstream>

namespace weir::test {
namespace {

void open(const std::string& name) {
  try {
    openDevice(name);
  } catch (const Error& e) {
    throw usageError("WEIR_REQUIRE_DEVICES: the device '" + name + "' cannot be opened: " + e.what());
  }
}

bool opens(const std::string& name) {
  try {
    openDevice(name);
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::vector<std::string> devicesOfEnvironment() {
  const char* required = std::getenv("WEIR_REQUIRE_DEVICES");
  try {
    return testedDevices(required != nullptr ? required : "");
  } catch (const Error& e) {
    // Not thrown on: GoogleTest asks while it makes its list of tests, where nobody catches.
    std::fprintf(stderr, "error: %s\n", e.what());
    std::exit(1);
  }
}

}  // namespace

std::vector<std::string> testedDevices(const std::string& required) {
  std::istringstream names(required);
  for (std::string name; std::getline(names, name, ',');) {
    if (name != "cpu" && name != "cuda")
      throw usageError("WEIR_REQUIRE_DEVICES: found '" + name + "'",
                       "\"cpu\" and \"cuda\", separated by commas");
    open(name);
  }
  return opens("cuda") ? std::vector<std::string>{"cpu", "cuda"} : std::vector<std::string>{"cpu"};
}

const std::vector<std::string>& availableDevices() {
  static const std::vector<std::string> devices = devicesOfEnvironment();
  return devices;
}

}  // namespace weir::test
