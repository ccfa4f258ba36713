// What passes as it is out of code of plugins, and what becomes an Error that names them.
#include "framework/graph/guard.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include "framework/base/error.h"
#include "framework/communication/communicator.h"

namespace weir::test {
namespace {

template <class Thrown>
void guarded(const Thrown& thrown) {
  GuardedPart{.what = "output 'points'", .source = "plugin lift"}.call("write", [&] { throw thrown; });
}

TEST(Guard, WhatIsNoMistakeOfAPluginPassesAsItIs) {
  EXPECT_THROW(guarded(std::bad_alloc()), std::bad_alloc);
  EXPECT_THROW(guarded(RanksEnded()), RanksEnded);
}

TEST(Guard, AnyOtherExceptionBecomesAnErrorThatNamesThePlugin) {
  try {
    guarded(std::runtime_error("no more ink"));
    FAIL() << "nothing was thrown";
  } catch (const Error& e) {
    EXPECT_NE(e.message().find("no more ink"), std::string::npos);
    EXPECT_EQ(e.location().part, "output 'points', write (plugin lift)");
  }
}

}  // namespace
}  // namespace weir::test
