#include "framework/compute/profiler.h"
#include "framework/compute/dispatch.h"

#include "framework/base/check.h"
#include "tests/framework/compute/kernels.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

class ProfilerTest : public OnDevice {
 protected:
  /// Some work on the device.
  void work() {
    dispatch(*device, [&](auto& d) { writeSquares(d, numbers.size(), numbers.view()); });
  }
  std::vector<std::string> paths() {
    std::vector<std::string> result;
    for (const ProfileEntry& entry : profiler.entries()) result.push_back(entry.path);
    return result;
  }

  Profiler& profiler = device->profiler();
  Array<std::int64_t> numbers{*device, 400000};
};
WEIR_ON_EVERY_DEVICE(ProfilerTest);

TEST_P(ProfilerTest, ScopesNestAndAddUp) {
  EXPECT_EQ(profiler.currentPath(), "");
  for (int i = 0; i < 3; ++i) {
    const ProfileScope node(profiler, "water");
    for (int k = 0; k < 2; ++k) {
      const ProfileScope module(profiler, "solver");
      EXPECT_EQ(profiler.currentPath(), "water/solver");
      work();
    }
    const ProfileScope module(profiler, "viscosity");
    work();
  }
  {
    const ProfileScope node(profiler, "glass");
    const ProfileScope module(profiler, "solver");
  }
  EXPECT_EQ(profiler.currentPath(), "");
  const std::vector<ProfileEntry> entries = profiler.entries();
  ASSERT_EQ(paths(),
            (std::vector<std::string>{"water", "water/solver", "water/viscosity", "glass", "glass/solver"}));
  const int depths[] = {0, 1, 1, 0, 1};
  const std::uint64_t calls[] = {3, 6, 3, 1, 1};
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EXPECT_EQ(entries[i].depth, depths[i]) << entries[i].path;
    EXPECT_EQ(entries[i].calls, calls[i]) << entries[i].path;
    EXPECT_GE(entries[i].totalMs, 0) << entries[i].path;
  }
  EXPECT_GT(entries[1].totalMs, 0);
  // Events tick every half microsecond; twelve of them lie inside the outer scopes.
  EXPECT_GE(entries[0].totalMs + 0.02, entries[1].totalMs + entries[2].totalMs);
}

TEST_P(ProfilerTest, KernelsAreTimedOnlyWhenAskedFor) {
  work();
  EXPECT_TRUE(paths().empty());
  profiler.timeKernels(true);
  EXPECT_TRUE(profiler.timesKernels());
  {
    const ProfileScope node(profiler, "water");
    work();
    work();
  }
  EXPECT_EQ(paths(), (std::vector<std::string>{"water", "water/writeSquares"}));
  EXPECT_EQ(profiler.entries()[1].calls, 2u);
}

TEST_P(ProfilerTest, StepsAreListedInOrder) {
  for (int i = 0; i < 5; ++i) {
    profiler.beginStep();
    work();
    profiler.endStep();
    profiler.poll();
  }
  const std::vector<double> steps = profiler.stepMs();
  ASSERT_EQ(steps.size(), 5u);
  for (const double ms : steps) EXPECT_GT(ms, 0);
}

TEST_P(ProfilerTest, AStepThatFailedCountsForNothing) {
  profiler.beginStep();
  work();
  profiler.beginStep();
  profiler.endStep();
  EXPECT_EQ(profiler.stepMs().size(), 1u);
  EXPECT_THROW(profiler.endStep(), InternalError);
}

TEST_P(ProfilerTest, ClearForgetsTotalsButNotOpenScopes) {
  profiler.beginStep();
  {
    const ProfileScope node(profiler, "water");
    { const ProfileScope module(profiler, "solver"); }
    profiler.clear();
    EXPECT_EQ(profiler.currentPath(), "water");
  }
  profiler.endStep();
  EXPECT_EQ(paths(), (std::vector<std::string>{"water"}));
  EXPECT_EQ(profiler.stepMs().size(), 1u);
  profiler.clear();
  EXPECT_TRUE(paths().empty());
  EXPECT_TRUE(profiler.stepMs().empty());
}

TEST_P(ProfilerTest, ScopesCloseWhenAnErrorTravels) {
  try {
    const ProfileScope node(profiler, "water");
    const ProfileScope module(profiler, "solver");
    throw simulationError("diverged");
  } catch (const Error&) {
    EXPECT_EQ(profiler.currentPath(), "");
  }
}

}  // namespace
}  // namespace weir::test
