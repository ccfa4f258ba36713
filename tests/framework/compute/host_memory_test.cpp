// What is left of the machine's memory, from files as Linux writes them.
#include "framework/compute/host_memory.h"

#include <gtest/gtest.h>

#include "tests/support/child_process.h"

namespace weir {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMiB = std::size_t{1} << 20;

class HostMemory : public testing::Test {
 protected:
  HostMemory() {
    write("proc/meminfo", "MemTotal:  9000000 kB\nMemAvailable:    4096000 kB\nSwapFree:  1024000 kB\n");
  }

  void write(const std::string& name, const std::string& text) {
    fs::create_directories(fs::path(folder_ / name).parent_path());
    folder_.write(name, text);
  }
  std::size_t available() const { return availableHostMemory({folder_ / "proc", folder_ / "cgroup"}); }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(HostMemory, IsWhatTheMachineHasAndItsSwap) {
  EXPECT_EQ(available(), 5000 * kMiB);
  write("proc/self/cgroup", "0::/some/group\n");
  write("cgroup/some/group/memory.max", "max\n");
  write("cgroup/some/group/memory.current", "123456\n");
  EXPECT_EQ(available(), 5000 * kMiB) << "a group without a limit";
}

TEST_F(HostMemory, IsNoMoreThanAnyControlGroupLeaves) {
  write("proc/self/cgroup", "0::/outer/inner\n");
  write("cgroup/outer/memory.max", std::to_string(300 * kMiB));
  write("cgroup/outer/memory.current", std::to_string(250 * kMiB));
  write("cgroup/outer/memory.stat", "anon 1\ninactive_file " + std::to_string(30 * kMiB) + "\nslab 5\n");
  write("cgroup/outer/inner/memory.max", std::to_string(200 * kMiB));
  write("cgroup/outer/inner/memory.current", std::to_string(10 * kMiB));
  EXPECT_EQ(available(), 80 * kMiB) << "50 MiB are free around the group, and 30 more could be";
  write("cgroup/outer/inner/memory.max", std::to_string(40 * kMiB));
  EXPECT_EQ(available(), 30 * kMiB);
  write("cgroup/outer/inner/memory.current", std::to_string(41 * kMiB));
  EXPECT_EQ(available(), 0u);
}

TEST_F(HostMemory, KnowsControlGroupsOfVersionOne) {
  write("proc/self/cgroup", "12:cpuset:/a\n5:cpu,memory:/box\n");
  write("cgroup/memory/box/memory.limit_in_bytes", std::to_string(64 * kMiB));
  write("cgroup/memory/box/memory.usage_in_bytes", std::to_string(60 * kMiB));
  write("cgroup/memory/box/memory.stat", "total_inactive_file " + std::to_string(8 * kMiB) + "\n");
  EXPECT_EQ(available(), 12 * kMiB);
}

TEST(HostMemoryOfThisMachine, IsAboveZero) {
  EXPECT_GT(availableHostMemory(), kMiB);
}

}  // namespace
}  // namespace weir
