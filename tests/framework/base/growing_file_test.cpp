// A file that grows: what stands in it after errors, and what a later run goes on with.
#include "framework/base/growing_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <optional>
#include <string>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

using test::readFile;

TEST(GrowingFile, ReplacesWhatStoodThereAndHasEachPieceAtOnce) {
  const test::TemporaryFolder folder;
  folder.write("f.txt", "an older, longer text");
  GrowingFile file(folder / "f.txt");
  EXPECT_EQ(readFile(folder / "f.txt"), "");
  file.append("one\n");
  file.append("");
  file.append("two\n");
  EXPECT_EQ(readFile(folder / "f.txt"), "one\ntwo\n");
  EXPECT_EQ(file.sync().bytes, 8);
  file.close();
}

TEST(GrowingFile, GoesOnBehindAMarkAndCutsWhatFollows) {
  const test::TemporaryFolder folder;
  // Longer than what is read at once.
  const std::string first(200000, 'a');
  std::optional<GrowingFile> file(folder / "f.txt");
  file->append(first);
  const GrowingFile::Mark mark = file->sync();
  EXPECT_EQ(mark.digest, GrowingFile::markOf(first).digest);
  file->append("lost");
  file.emplace(folder / "f.txt", mark);
  file->append("kept");
  EXPECT_EQ(readFile(folder / "f.txt"), first + "kept");
  EXPECT_EQ(file->sync().digest, GrowingFile::markOf(first + "kept").digest);
}

TEST(GrowingFile, RefusesToGoOnWithAnother) {
  const test::TemporaryFolder folder;
  const GrowingFile::Mark mark = GrowingFile::markOf("0123456789");
  for (const std::string found : {"012345678", "01234x6789", "01234x6789 and more", ""}) {
    folder.write("f.txt", found);
    const Error e = test::errorOf([&] { GrowingFile(folder / "f.txt", mark); });
    EXPECT_EQ(e.kind(), ErrorKind::kIo);
    EXPECT_CONTAINS(e.what(), folder / "f.txt");
    EXPECT_EQ(readFile(folder / "f.txt"), found);
  }
  EXPECT_CONTAINS(test::errorOf([&] { GrowingFile(folder / "none.txt", mark); }).what(), folder / "none.txt");
}

TEST(GrowingFile, HasNoPartOfAPieceThatCouldNotBeWritten) {
  const test::TemporaryFolder folder;
  GrowingFile file(folder / "f.txt");
  file.append("0123456789");
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto signalBefore = std::signal(SIGXFSZ, SIG_IGN);
  rlimit least = before;
  least.rlim_cur = 15;
  ::setrlimit(RLIMIT_FSIZE, &least);
  EXPECT_THROW(file.append("0123456789"), Error);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, signalBefore);
  EXPECT_EQ(readFile(folder / "f.txt"), "0123456789");
  file.append("more");
  EXPECT_EQ(readFile(folder / "f.txt"), "0123456789more");
}

}  // namespace
}  // namespace weir
