// Files that are written at once: what is brought to the disk, and in which order.
#include "framework/base/file_output.h"

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace {

// What the framework asked of the system, in order. The exported functions below stand in front of the C
// library's.
std::vector<std::string> asked;

template <class F>
F* realFunction(const char* name) {
  return reinterpret_cast<F*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" __attribute__((visibility("default"))) int fsync(int file) {
  struct stat status {};
  ::fstat(file, &status);
  asked.emplace_back(S_ISDIR(status.st_mode) ? "fsync folder" : "fsync file");
  return realFunction<int(int)>("fsync")(file);
}

extern "C" __attribute__((visibility("default"))) int rename(const char* from, const char* to) noexcept {
  asked.emplace_back("rename");
  return realFunction<int(const char*, const char*)>("rename")(from, to);
}

namespace weir::test {
namespace {

// A power cut may otherwise leave the new name with the old content, or no name at all.
TEST(FileOutput, ContentAndNameAreOnTheDiskInThisOrder) {
  const TemporaryFolder folder;
  folder.write("a.json", "old");
  asked.clear();
  writeFileAtomically(folder / "a.json", "new");
  EXPECT_EQ(asked, (std::vector<std::string>{"fsync file", "rename", "fsync folder"}));
  EXPECT_EQ(readFile(folder / "a.json"), "new");
}

TEST(FileOutput, AFolderThatIsGoneCannotBeSynced) {
  EXPECT_EQ(errorOf([] { syncFolderOf("/none/such/file"); }).kind(), ErrorKind::kIo);
  EXPECT_NO_THROW(syncFolderOf("a file in the current folder"));
}

}  // namespace
}  // namespace weir::test
