#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "framework/scene/scene_file.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

using test::errorOf;

TEST(ReadTextFile, ReadsAllBytes) {
  const std::filesystem::path path = testing::TempDir() + "weir_text_file_test.txt";
  const std::string text = std::string(200000, 'x') + std::string("\0\r\né", 5);
  std::ofstream(path, std::ios::binary) << text;
  EXPECT_EQ(readTextFile(path, text.size()), text);
  const Error e = errorOf([&] { readTextFile(path, text.size() - 1); });
  EXPECT_EQ(e.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(e.what(), "larger than 200004 bytes");
  std::filesystem::remove(path);
}

TEST(ReadTextFile, SaysWhyItCannot) {
  const Error missing = errorOf([] { readTextFile("no_such_file.json", 100); });
  EXPECT_EQ(missing.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(missing.what(), "no_such_file.json: the file cannot be read: No such file");
  EXPECT_CONTAINS(missing.hint(), std::filesystem::current_path().string());
  EXPECT_CONTAINS(errorOf([] { readTextFile("/", 100); }).what(), "it is a folder");
  EXPECT_CONTAINS(errorOf([] { readTextFile("/dev/zero", 100); }).what(), "larger than 100 bytes");
}

}  // namespace
}  // namespace weir
