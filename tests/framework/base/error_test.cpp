#include "framework/base/error.h"

#include <gtest/gtest.h>

#include "framework/base/check.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

TEST(Error, SaysWhereWhatAllowedAndHint) {
  Error e = sceneError("found -1", "a number above 0", "spacings are lengths");
  e.at({.file = "s.json", .line = 3, .column = 9, .pointer = "/nodes/water"});
  e.inNode("water").inParameter("spacing");
  EXPECT_STREQ(e.what(),
               "s.json:3:9: /nodes/water: node 'water': parameter 'spacing': found -1\n"
               "  allowed: a number above 0\n  hint: spacings are lengths");
}

TEST(Error, TheInnermostPlaceStays) {
  Error e = sceneError("x");
  e.at({.file = "s.json", .line = 3, .column = 9, .pointer = "/a/b"});
  e.at({.file = "s.json", .line = 1, .column = 1, .pointer = "/a", .node = "n"});
  EXPECT_EQ(e.location().line, 3);
  EXPECT_EQ(e.location().pointer, "/a/b");
  EXPECT_EQ(e.location().node, "n");
}

TEST(Error, AnotherFilesLineIsNotMixedIn) {
  Error e = sceneError("x");
  e.at({.file = "--set a.b=1", .pointer = "/a/b"});
  e.at({.file = "s.json", .line = 7, .column = 1});
  EXPECT_EQ(e.location().line, 0);
  EXPECT_EQ(e.location().file, "--set a.b=1");
}

TEST(Error, NamesInItCannotFloodATerminal) {
  Error e = sceneError("x");
  e.at({.file = "s.json", .pointer = "/" + std::string(1 << 20, '\x1b')});
  EXPECT_LT(std::string(e.what()).size(), 400u);
  EXPECT_EQ(std::string(e.what()).find('\x1b'), std::string::npos);
}

TEST(Error, KindsAreExitCodes) {
  EXPECT_EQ(exitCode(ErrorKind::kUsage), 2);
  EXPECT_EQ(exitCode(ErrorKind::kScene), 3);
  EXPECT_EQ(exitCode(ErrorKind::kSimulation), 4);
  EXPECT_EQ(exitCode(ErrorKind::kIo), 5);
}

TEST(Check, TakesAWholeSideOfAComparison) {
  const int a = 3;
  WEIR_CHECK(a << 1 == a + a);
  try {
    WEIR_CHECK(a << 1 < a + 1);
    FAIL() << "nothing was thrown";
  } catch (const InternalError& e) {
    EXPECT_CONTAINS(e.what(), "6 < 4");
  }
}

TEST(Check, PrintsBothValues) {
  const int a = 3, b = 2;
  WEIR_CHECK(b < a);
  try {
    WEIR_CHECK(a < b);
    FAIL() << "nothing was thrown";
  } catch (const InternalError& e) {
    EXPECT_CONTAINS(e.what(), "a < b");
    EXPECT_CONTAINS(e.what(), "3 < 2");
  }
}

}  // namespace
}  // namespace weir
