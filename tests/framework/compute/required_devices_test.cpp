// A device that WEIR_REQUIRE_DEVICES promises is tested, or the tests fail.
#include <gtest/gtest.h>

#include "tests/support/child_process.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

/// The tests of this program, listed where no CUDA device can be opened.
ChildResult listTestsWithoutCuda(const std::string& required) {
  return runChild(buildFolder() + "/bin/weir_framework_tests", {"--gtest_list_tests"},
                  {.environment = {{"WEIR_REQUIRE_DEVICES", required}, {"CUDA_VISIBLE_DEVICES", "-1"}}});
}

TEST(RequiredDevices, OneThatCannotBeOpenedEndsTheTestProgram) {
  const ChildResult result = listTestsWithoutCuda("cpu,cuda");
  EXPECT_EQ(result.code, 1);
  EXPECT_CONTAINS(result.err, "error: WEIR_REQUIRE_DEVICES: the device 'cuda' cannot be opened: ");
  EXPECT_EQ(result.out.find("RequiredDevices"), std::string::npos);
}

TEST(RequiredDevices, OneThatIsNotRequiredMayBeMissing) {
  for (const char* required : {"", "cpu"}) {
    const ChildResult result = listTestsWithoutCuda(required);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_CONTAINS(result.out, "RequiredDevices");
  }
}

TEST(RequiredDevices, UnknownNamesAreErrorsThatSayWhatIsAllowed) {
  for (const char* required : {"gpu", "cpu, cuda", "cpu,,cuda", "auto"}) {
    const Error error = errorOf([&] { testedDevices(required); });
    EXPECT_CONTAINS(error.what(), "WEIR_REQUIRE_DEVICES: found '") << required;
    EXPECT_CONTAINS(error.what(), "\"cpu\" and \"cuda\"") << required;
  }
}

}  // namespace
}  // namespace weir::test
