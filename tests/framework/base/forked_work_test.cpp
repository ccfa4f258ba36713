// Work in a copy of this process: what comes back from it, and how ends are told apart.
#include "framework/base/forked_work.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <stdexcept>

#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

TEST(ForkedWork, GivesBackBytesAndChangesNothingHere) {
  int number = 1;
  const ForkedEnd end =
      ForkedWork([&] { return std::string("a\0b", 3) + std::to_string(++number); }, {}).wait();
  EXPECT_TRUE(end.done);
  EXPECT_EQ(end.bytes, std::string("a\0b2", 4));
  EXPECT_EQ(number, 1);
  EXPECT_EQ(end.signal, 0);
}

TEST(ForkedWork, TellsEndsApart) {
  const ForkedEnd crashed = ForkedWork([]() -> std::string { ::raise(SIGSEGV), ::_exit(9); }, {}).wait();
  EXPECT_FALSE(crashed.done);
  EXPECT_EQ(crashed.signal, SIGSEGV);
  EXPECT_FALSE(crashed.outOfTime);
  const ForkedEnd left = ForkedWork([]() -> std::string { ::_exit(7); }, {}).wait();
  EXPECT_FALSE(left.done);
  EXPECT_EQ(left.signal, 0);
  EXPECT_EQ(left.exitCode, 7);
  const auto sleep = []() -> std::string {
    while (true) ::pause();
  };
  const ForkedEnd late = ForkedWork(sleep, {.seconds = 1}).wait();
  EXPECT_FALSE(late.done);
  EXPECT_TRUE(late.outOfTime);
}

TEST(ForkedWork, AnExceptionEndsTheCopyAndSaysWhatItIs) {
  const auto fails = []() -> std::string { throw std::runtime_error("no licence"); };
  const ForkedEnd told = ForkedWork(fails, {.keepsStderr = true}).wait();
  EXPECT_FALSE(told.done);
  EXPECT_NE(told.signal, 0);
  EXPECT_CONTAINS(told.bytes, "no licence");
  EXPECT_EQ(ForkedWork(fails, {}).wait().bytes, "");
}

}  // namespace
}  // namespace weir::test
