// Locks of outputs: who has one keeps others from it, and nothing is left over.
#include "framework/base/output_lock.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

TEST(OutputLock, KeepsOthersFromTheSamePath) {
  const TemporaryFolder folder;
  auto first = std::make_unique<OutputLock>(folder / "a.mp4");
  const Error e = errorOf([&] { OutputLock(folder / "a.mp4"); });
  EXPECT_EQ(e.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(e.what(), folder / "a.mp4");
  EXPECT_CONTAINS(e.message(), "process " + std::to_string(::getpid()));
  EXPECT_NO_THROW(OutputLock(folder / "b.mp4"));
  OutputLock moved = std::move(*first);
  first.reset();
  EXPECT_THROW(OutputLock(folder / "a.mp4"), Error);
}

TEST(OutputLock, LeavesNothing) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "pictures");
  for (const std::string name : {"a.mp4", "pictures", "pictures/"})
    for (int k = 0; k < 2; ++k) EXPECT_NO_THROW(OutputLock(folder / name));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
  EXPECT_TRUE(fs::is_empty(folder / "pictures"));
  EXPECT_NO_THROW(OutputLock("/dev/null"));
  EXPECT_FALSE(fs::exists("/dev/.null.lock"));
}

}  // namespace
}  // namespace weir::test
