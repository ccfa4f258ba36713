// Work in a copy of this process: what comes back from it, and how ends are told apart.
#include "framework/base/forked_work.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "framework/base/sanitizers.h"
#include "tests/support/child_process.h"
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

TEST(ForkedWork, MemoryBeyondTheLimitIsToldFromACrash) {
#if defined(WEIR_ADDRESS_SANITIZER) || defined(WEIR_THREAD_SANITIZER)
  GTEST_SKIP() << "sanitizers have no such limit";
#endif
  const auto take = [](std::size_t megabytes) {
    return [=] {
      const std::vector<char> memory(megabytes << 20, 'x');
      return std::string(1, memory.back());
    };
  };
  const ForkedLimits limits{.memoryBytes = std::uint64_t{256} << 20};
  EXPECT_EQ(ForkedWork(take(100), limits).wait().bytes, "x");
  const ForkedEnd end = ForkedWork(take(400), limits).wait();
  EXPECT_FALSE(end.done);
  EXPECT_TRUE(end.outOfMemory);
  EXPECT_FALSE(end.outOfTime);
}

TEST(ForkedWork, ResultsBeyondTheLimitAreNotTaken) {
  const auto flood = [] { return std::string(std::size_t{50} << 20, 'x'); };
  const ForkedEnd end = ForkedWork(flood, {.resultBytes = 1 << 20}).wait();
  EXPECT_FALSE(end.done);
  EXPECT_TRUE(end.outOfMemory);
  EXPECT_LT(end.bytes.size(), 2u << 20);
  EXPECT_TRUE(ForkedWork(flood, {.resultBytes = 60 << 20}).wait().done);
}

TEST(ForkedWork, WritesNoFilesWhereItMayNot) {
  const TemporaryFolder folder;
  const std::string path = folder / "written";
  const auto write = [&] {
    std::ofstream(path) << "some text";
    return std::string("done");
  };
  EXPECT_FALSE(ForkedWork(write, {.writesFiles = false}).wait().done);
  EXPECT_EQ(readFile(path), "");
  EXPECT_TRUE(ForkedWork(write, {}).wait().done);
  EXPECT_EQ(readFile(path), "some text");
}

// A thread may have blocked the signals by which the copy is to end.
TEST(ForkedWork, EndsInTimeWhateverSignalsAreBlockedHere) {
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, &before);
  const auto sleep = []() -> std::string {
    while (true) ::pause();
  };
  const ForkedEnd late = ForkedWork(sleep, {.seconds = 1}).wait();
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_TRUE(late.outOfTime);
}

}  // namespace
}  // namespace weir::test
