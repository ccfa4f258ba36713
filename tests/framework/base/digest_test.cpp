// Digests tell contents apart.
#include "framework/base/digest.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

// The check value of CRC-32: a file must mean the same on every machine and with every version of the
// library.
TEST(Digest, IsCrc32) {
  const std::string_view digits = "123456789";
  EXPECT_EQ(Digest().add(std::as_bytes(std::span(digits))).value(), 0xCBF43926u);
  EXPECT_EQ(Digest().value(), 0u);
}

TEST(Digest, EveryFlippedBitGivesAnother) {
  std::string text(300, 'a');
  std::set<std::uint32_t> found{Digest().addText(text).value()};
  for (std::size_t bit = 0; bit < 8 * text.size(); ++bit) {
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ (1 << bit % 8));
    found.insert(Digest().addText(text).value());
    text[bit / 8] = static_cast<char>(text[bit / 8] ^ (1 << bit % 8));
  }
  EXPECT_EQ(found.size(), 1 + 8 * text.size());
  EXPECT_NE(Digest().addText("ab").addText("c").value(), Digest().addText("a").addText("bc").value());
}

TEST(Digest, OfAFileIsThatOfItsContent) {
  const TemporaryFolder folder;
  const std::string text(3'000'001, 'x');  // more than is read at once
  const FileDigest digest = digestOfFile(folder.write("a", text));
  EXPECT_EQ(digest.bytes, text.size());
  EXPECT_EQ(digest.digest, Digest().add(std::as_bytes(std::span(text))).value());
  EXPECT_EQ(errorOf([&] { digestOfFile(folder / "none"); }).location().file, folder / "none");
}

}  // namespace
}  // namespace weir::test
