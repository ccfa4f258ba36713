#include "framework/compute/cpu_isa.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <string>

#include "framework/base/error.h"
#include "framework/compute/dispatch.h"

namespace weir::test {
namespace {

/// Sets WEIR_CPU_ISA while it lives.
class Told {
 public:
  explicit Told(const std::string& isa) {
    if (const char* before = std::getenv(kName)) before_ = before;
    ::setenv(kName, isa.c_str(), 1);
  }
  ~Told() { before_ ? ::setenv(kName, before_->c_str(), 1) : ::unsetenv(kName); }

 private:
  static constexpr const char* kName = "WEIR_CPU_ISA";
  std::optional<std::string> before_;
};

TEST(CpuIsa, TheBaselineIsUsableEverywhere) {
  EXPECT_EQ(usableCpuIsas().front(), CpuIsa::kBaseline);
  for (const CpuIsa isa : usableCpuIsas()) EXPECT_TRUE(isUsable(isa));
}

TEST(CpuIsa, TheVariableChoosesAndNothingMeansTheBest) {
  for (const CpuIsa isa : usableCpuIsas()) {
    const Told told{std::string(cpuIsaName(isa))};
    EXPECT_EQ(chosenCpuIsa(), isa);
    EXPECT_EQ(CpuDevice(1).isa(), isa);
    EXPECT_NE(CpuDevice(1).description().find(cpuIsaName(isa)), std::string::npos);
  }
  const Told told("");
  EXPECT_EQ(chosenCpuIsa(), usableCpuIsas().back());
}

TEST(CpuIsa, AnUnknownNameIsAnErrorThatNamesThoseThereAre) {
  const Told told("AVX9");
  try {
    openDevice("cpu");
    FAIL() << "no error";
  } catch (const Error& error) {
    const std::string message = error.message();
    EXPECT_NE(message.find("WEIR_CPU_ISA"), std::string::npos) << message;
    EXPECT_NE(message.find("AVX9"), std::string::npos) << message;
    EXPECT_NE(std::string(error.what()).find("baseline"), std::string::npos) << error.what();
  }
}

TEST(CpuIsa, DispatchPassesTheOneThatTheDeviceWasOpenedFor) {
  struct {
    CpuIsa operator()(CpuDevice&) { return CpuIsa::kBaseline; }
    CpuIsa operator()(CpuAvx2&) { return CpuIsa::kAvx2; }
    CpuIsa operator()(CpuAvx512&) { return CpuIsa::kAvx512; }
    CpuIsa operator()(CudaDevice&) { return CpuIsa::kBaseline; }
  } which;
  for (const CpuIsa isa : usableCpuIsas()) {
    CpuDevice device(1, isa);
    EXPECT_EQ(dispatch(device, which), isa);
  }
}

}  // namespace
}  // namespace weir::test
