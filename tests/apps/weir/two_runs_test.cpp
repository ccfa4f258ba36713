// Two runs into the same outputs: the second says who writes there.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

TEST(TwoRuns, TheSecondIntoTheSameOutputIsRefused) {
  const TemporaryFolder folder;
  const std::string scene = resourcesFolder() + "/scenes/dam_break.json";
  const auto run = [&](const std::string& stats, const std::vector<std::string>& more,
                       const ChildOptions& options) {
    std::vector<std::string> arguments{"run", scene, "--set", "water.spacing=0.1", "--stats", stats};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runWeir(arguments, options);
  };
  ChildResult second, other;
  int holder = 0;
  ChildOptions options;
  // The first one has begun when it says something; it goes on until the others have ended.
  options.onStderr = [&](int pid, const std::string&) {
    if (holder != 0) return;
    holder = pid;
    ::kill(pid, SIGSTOP);
    second = run(folder / "a.json", {"--frames", "1"}, {});
    other = run(folder / "b.json", {"--frames", "1"}, {});
    ::kill(pid, SIGCONT);
    ::kill(pid, SIGINT);
  };
  const ChildResult first = run(folder / "a.json", {"--duration", "1000"}, options);
  EXPECT_EQ(first.code, 130) << first.err;
  ASSERT_NE(holder, 0);
  EXPECT_EQ(second.code, 5) << second.err;
  EXPECT_CONTAINS(second.err, "a.json: another run writes there: process " + std::to_string(holder) + " on ");
  EXPECT_EQ(other.code, 0) << other.err;
  // Nothing is left over, and the next run has it.
  EXPECT_EQ(run(folder / "a.json", {"--frames", "1"}, {}).code, 0);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 2u);
}

TEST(TwoRuns, OneThatWasKilledHoldsNobodyUp) {
  const TemporaryFolder folder;
  ChildOptions options;
  options.onStderr = [](int pid, const std::string&) { ::kill(pid, SIGKILL); };
  const auto run = [&](const std::string& option, const std::string& value, const ChildOptions& how) {
    return runWeir({"run", resourcesFolder() + "/scenes/dam_break.json", option, value, "--set",
                    "water.spacing=0.1", "--stats", folder / "a.json"},
                   how);
  };
  EXPECT_EQ(run("--duration", "1000", options).signal, SIGKILL);
  EXPECT_TRUE(std::filesystem::exists(folder / ".a.json.lock"));
  EXPECT_EQ(run("--frames", "2", {}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / ".a.json.lock"));
}

}  // namespace
}  // namespace weir::test
