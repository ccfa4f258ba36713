#include "framework/base/text.h"

#include <gtest/gtest.h>

namespace weir {
namespace {

TEST(Utf8, LengthsOfValidSequences) {
  EXPECT_EQ(utf8Length("a", 0), 1u);
  EXPECT_EQ(utf8Length("é", 0), 2u);
  EXPECT_EQ(utf8Length("数", 0), 3u);
  EXPECT_EQ(utf8Length("🌊", 0), 4u);
  EXPECT_EQ(utf8Length("aé", 1), 2u);
}

TEST(Utf8, RefusesWhatUnicodeRefuses) {
  for (const char* bad : {"\x80", "\xC0\x80", "\xC1\xBF", "\xC3", "\xE0\x80\x80", "\xED\xA0\x80", "\xE6\x95",
                          "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"})
    EXPECT_FALSE(isUtf8(bad)) << printable(bad);
  EXPECT_EQ(utf8Length("", 0), 0u);
  EXPECT_TRUE(isUtf8(""));
  EXPECT_TRUE(isUtf8("Tür 数 🌊"));
}

TEST(Printable, EscapesWhatATerminalWouldObey) {
  EXPECT_EQ(printable("a\nb\t\x1b[31m\x7f\xFFé"), "a\\nb\\t\\u001b[31m\\u007f\\xffé");
  EXPECT_EQ(inQuotes("x"), "'x'");
}

TEST(Printable, CutsBetweenCharacters) {
  EXPECT_EQ(printable("abcdef", 3), "abc…");
  EXPECT_EQ(printable("ab数", 4), "ab…");
  EXPECT_EQ(printable("ab数", 5), "ab数");
}

TEST(LowerCase, ChangesAsciiLettersOnly) {
  EXPECT_EQ(lowerCase(".VtkHDF 1_Z[@"), ".vtkhdf 1_z[@");
  EXPECT_EQ(lowerCase("Ä"), "Ä");
}

TEST(Name, LettersDigitsUnderscoreHyphen) {
  for (const char* good : {"a", "Tank_2", "x-y"}) EXPECT_TRUE(isName(good)) << good;
  for (const char* bad : {"", "2x", "_a", "-a", "a b", "a.b", "a/b", "tür"}) EXPECT_FALSE(isName(bad)) << bad;
  EXPECT_TRUE(isName(std::string(100, 'n')));
  EXPECT_FALSE(isName(std::string(101, 'n')));
}

}  // namespace
}  // namespace weir
