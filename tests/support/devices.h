// The devices that a test runs on: every back end of the build that works on this machine.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/base/error.h"
#include "framework/compute/device.h"

namespace weir::test {

/// "cpu", and "cuda" where a CUDA device can be opened. `required`, such as "cpu,cuda", names devices that
/// must be there: throws a weir::Error where one of them cannot be opened.
std::vector<std::string> testedDevices(const std::string& required);

/// The same for the environment variable WEIR_REQUIRE_DEVICES, which is empty where it is not set. Ends the
/// program, with a message, where a required device is missing, so that none is left out in silence.
const std::vector<std::string>& availableDevices();

/// A test that runs once on each device:
///   using MyTest = OnDevice;
///   TEST_P(MyTest, Adds) { … *device … }
///   WEIR_ON_EVERY_DEVICE(MyTest);
class OnDevice : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Device> device = openDevice(GetParam());
};

}  // namespace weir::test

// A macro, because it names the suite to GoogleTest's own macro.
#define WEIR_ON_EVERY_DEVICE(Suite)                                                             \
  INSTANTIATE_TEST_SUITE_P(Devices, Suite, testing::ValuesIn(::weir::test::availableDevices()), \
                           [](const auto& tested) { return tested.param; })
