#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "framework/scene/scene_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/scene_mutator.h"

namespace weir {
namespace {

using test::errorOf;

Value parse(std::string_view text) {
  return parseJson(text, "s.json");
}

TEST(ParseJson, EveryKindOfValue) {
  const Value v = parse(R"({"a": [null, true, false, 1, -2, 2.5, 1e3, "x\n\u00e9\ud83c\udf0a"], "b": {}})");
  const auto& a = v.find("a")->asArray();
  EXPECT_TRUE(a[0].isNull());
  EXPECT_TRUE(a[1].asBool());
  EXPECT_FALSE(a[2].asBool());
  EXPECT_EQ(a[3].asInt(), 1);
  EXPECT_EQ(a[4].asInt(), -2);
  EXPECT_EQ(a[5].asDouble(), 2.5);
  EXPECT_EQ(a[6].asDouble(), 1000);
  EXPECT_FALSE(a[6].isInt());
  EXPECT_EQ(a[7].asString(), "x\né🌊");
  EXPECT_TRUE(v.find("b")->isObject());
}

TEST(ParseJson, EveryValueKnowsWhereItStarts) {
  const Value v =
      parse("{\n  \"tür\": 12,\n\t\"b\" : [ 1,-2.5e1 ,\n \"x\\\"y\", true],\r\n \"c\":{\"d\":null}\n}");
  const auto at = [](const Value& x) { return std::pair(x.line, x.column); };
  EXPECT_EQ(at(v), std::pair(1, 1));
  EXPECT_EQ(at(*v.find("tür")), std::pair(2, 10));  // a column is a character, not a byte
  const Value& b = *v.find("b");
  EXPECT_EQ(at(b), std::pair(3, 8));
  EXPECT_EQ(at(b.asArray()[0]), std::pair(3, 10));
  EXPECT_EQ(at(b.asArray()[1]), std::pair(3, 12));
  EXPECT_EQ(at(b.asArray()[2]), std::pair(4, 2));
  EXPECT_EQ(at(b.asArray()[3]), std::pair(4, 10));
  EXPECT_EQ(at(*v.find("c")), std::pair(5, 6));
  EXPECT_EQ(at(*v.find("c")->find("d")), std::pair(5, 11));
}

/// Checks every place against a search for the text that stands there: each number is unique.
TEST(ParseJson, PlacesAgreeWithASearch) {
  std::string text = "{";
  for (int i = 100; i < 160; ++i)
    text += (i > 100 ? std::string(i % 3 == 0 ? "\n ," : ", ") : std::string()) + "\"k" +
            std::string(i % 7, '\\') + std::string(i % 7 % 2, '\\') + "é\"" +
            std::string(i % 5, i % 2 == 0 ? '\n' : ' ') + ": [" + std::to_string(i) + "]";
  // Keys would be equal otherwise.
  for (std::size_t n = 0, at = 0; (at = text.find("\"k", at)) != std::string::npos; ++n, at += 3)
    text.insert(at + 2, std::to_string(n) + "_");
  text += "}";
  const Value v = parse(text);
  ASSERT_EQ(v.asObject().size(), 60u);
  for (int i = 100; i < 160; ++i) {
    const std::size_t offset = text.find("[" + std::to_string(i));
    int line = 1, column = 1;
    for (std::size_t k = 0; k < offset; ++k) {
      if (text[k] == '\n')
        ++line, column = 1;
      else if ((text[k] & 0xC0) != 0x80)
        ++column;
    }
    const Value& found = v.asObject()[static_cast<std::size_t>(i - 100)].second;
    EXPECT_EQ(found.line, line) << i;
    EXPECT_EQ(found.column, column) << i;
  }
}

TEST(ParseJson, AcceptsOneByteOrderMark) {
  EXPECT_EQ(parse("\xEF\xBB\xBF[1]").asArray()[0].column, 2);
  EXPECT_EQ(errorOf([] { parse("\xEF\xBB\xBF\xEF\xBB\xBF[1]"); }).kind(), ErrorKind::kScene);
}

struct BadText {
  std::string text;
  int line, column;
  const char* found;
  const char* allowedOrHint;
};

TEST(ParseJson, SaysWhatIsWrongAndWhere) {
  const BadText kBad[] = {
      {"", 1, 1, "the file is empty", "one JSON object"},
      {" \n ", 2, 2, "the file is empty", "one JSON object"},
      {"{", 1, 2, "the file ends inside what opens at line 1, column 1", "'}'"},
      {"{\"a\": [1,\n 2", 2, 3, "ends inside what opens at line 1, column 7", "',' or ']'"},
      {"{\"a\"", 1, 5, "the file ends", "':' and a value"},
      {"{\"a\":", 1, 6, "the file ends", "a value"},
      {"{\"a\": 1,", 1, 9, "the file ends", "a name"},
      {"{\"a\": \"xy", 1, 7, "ends inside a string", "closing"},
      {"{\"a\": \"xy\n\"}", 1, 7, "does not end on its line", "\\n"},
      {"[1, 2,]", 1, 7, "found ',' before ']'", "remove the last comma"},
      {"{\"a\": 1,}", 1, 9, "found ',' before '}'", "remove the last comma"},
      {"[1 2]", 1, 4, "found '2'", "',' or ']'"},
      {"[1 \"x\"]", 1, 4, "found a string", "a comma may be missing"},
      {"{\"a\": 1 \"b\": 2}", 1, 9, "found a string", "a comma may be missing"},
      {"{\"a\" 1}", 1, 6, "found '1'", "':' and a value"},
      {"{a: 1}", 1, 2, "found 'a'", "double quotes"},
      {"{'a': 1}", 1, 2, "single quote", "double quotes"},
      {"{1: 1}", 1, 2, "found '1'", "a name in double quotes"},
      {"[NaN]", 1, 2, "found 'NaN'", "no NaN"},
      {"[-Infinity]", 1, 2, "found '-Infinity'", "no infinity"},
      {"[True]", 1, 2, "found 'True'", "write true"},
      {"[None]", 1, 2, "found 'None'", "write null"},
      {"[tru]", 1, 2, "found 'tru'", "a value"},
      {"[truer]", 1, 2, "found 'truer'", "a value"},
      {"[1,\n// no\n2]", 2, 1, "found '//'", "comments are not part of JSON"},
      {"# x\n{}", 1, 1, "found '# '", "comments are not part of JSON"},
      {"[01]", 1, 2, "found '01', which is not a number", "no leading"},
      {"[+1]", 1, 2, "found '+1', which is not a number", "no leading"},
      {"[.5]", 1, 2, "found '.5', which is not a number", "both sides"},
      {"[1.]", 1, 2, "found '1.', which is not a number", "both sides"},
      {"[1e]", 1, 2, "found '1e', which is not a number", "1e-3"},
      {"[0x10]", 1, 2, "found '0x10'", "a number"},
      {"[1e999]", 1, 2, "the number 1e999 is too large", "1.7e308"},
      {"[-1e999]", 1, 2, "too large", "1.7e308"},
      {"[1e-999]", 1, 2, "too small", "4.9e-324"},
      {"[9223372036854775808]", 1, 2, "the integer 9223372036854775808 is too large", "exponent"},
      {"[123456789012345678901234567890]", 1, 2, "is too large", "exponent"},
      {"{\"a\": 1, \"b\": 2,\n \"a\": 3}", 2, 2, "two members \"a\"", "line 1"},
      {"[\"\\x\"]", 1, 3, "found the escape '\\x'", "\\uXXXX"},
      {"[\"\\u12g4\"]", 1, 3, "found '\\u12g4'", "four digits"},
      {"[\"a\\ud800b\"]", 1, 2, "surrogate", "UTF-8"},
      {"[\"a\tb\"]", 1, 4, "U+0009", "\\u0009"},
      {"[\"é\xFF\"]", 1, 4, "0xFF", "UTF-8"},
      {"[\xFF]", 1, 2, "0xFF", "UTF-8"},
      {"{} x", 1, 4, "found 'x'", "nothing after"},
      {"{}{}", 1, 3, "found '{'", "nothing after"},
      {std::string("{}\0{}", 5), 1, 3, "found '\\u0000'", "nothing after"},
      {"]", 1, 1, "found ']'", "one JSON object"},
      {"[}", 1, 2, "found '}'", "']'"},
      {"[1}", 1, 3, "found '}'", "',' or ']'"},
      {"[,1]", 1, 2, "found ','", "a value or ']'"},
      {"[1,,2]", 1, 4, "found ','", "a value"},
      {"{\"a\"::1}", 1, 6, "found ':'", "a value"},
      {"[é]", 1, 2, "found 'é'", "a value"},
  };
  for (const BadText& bad : kBad) {
    SCOPED_TRACE(bad.text);
    const Error e = errorOf([&] { parse(bad.text); });
    EXPECT_EQ(e.kind(), ErrorKind::kScene);
    EXPECT_EQ(e.location().file, "s.json");
    EXPECT_EQ(e.location().line, bad.line) << e.what();
    EXPECT_EQ(e.location().column, bad.column) << e.what();
    EXPECT_CONTAINS(e.message(), bad.found);
    EXPECT_CONTAINS(e.allowed() + " " + e.hint(), bad.allowedOrHint);
    EXPECT_FALSE(test::contains(e.what(), "json.exception"));
  }
}

TEST(ParseJson, NestingHasALimit) {
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_NO_THROW(parse(nested(kDeepestNesting)));
  const Error e = errorOf([&] { parse(nested(kDeepestNesting + 1)); });
  EXPECT_EQ(e.location().column, kDeepestNesting + 1);
  EXPECT_CONTAINS(e.message(), "64 deep");
  EXPECT_CONTAINS(errorOf([&] { parse(nested(1000000)); }).message(), "64 deep");
}

TEST(ParseJson, ManyMembersTakeNoQuadraticTime) {
  std::string text = "{";
  for (int i = 0; i < 300000; ++i) text += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":0";
  EXPECT_EQ(parse(text + "}").asObject().size(), 300000u);
}

TEST(WriteJson, LaysOutAScene) {
  const Value v =
      parse(R"({"weir":1,"nodes":{"water":{"type":"Fluid","params":{"spacing":0.01,"min":[-1,0,-9.8]}},
    "aVeryLongNameThatTakesRoom":{"type":"Fluid","params":{"spacing":0.01,"doc":"this one does not fit on a line"}}}})");
  EXPECT_EQ(writeJson(v), R"({
  "weir": 1,
  "nodes": {
    "water": { "type": "Fluid", "params": { "spacing": 0.01, "min": [-1, 0, -9.8] } },
    "aVeryLongNameThatTakesRoom": {
      "type": "Fluid",
      "params": { "spacing": 0.01, "doc": "this one does not fit on a line" }
    }
  }
}
)");
}

TEST(WriteJson, NumbersAndTextsKeepTheirValue) {
  const double kNumbers[] = {
      0.1, -0.0, 1e15, 1e16, 123456789012345680000.0, 5e-324, 1.7976931348623157e308, 1.0 / 3};
  for (const double d : kNumbers) {
    const Value back = parse(writeJson(Value(d)));
    EXPECT_EQ(back.asDouble(), d) << writeJson(Value(d));
    EXPECT_EQ(std::signbit(back.asDouble()), std::signbit(d));
  }
  EXPECT_EQ(writeJson(Value(0.1f)), "0.1\n");
  EXPECT_EQ(writeJson(Value(1e20)), "1e+20\n");
  EXPECT_EQ(writeJson(Value("é\"\\\n\t\x01/")), "\"é\\\"\\\\\\n\\t\\u0001/\"\n");
  EXPECT_EQ(writeJson(Value(std::numeric_limits<double>::quiet_NaN())), "null\n");
  EXPECT_EQ(writeJson(Value("a\xFF")), "\"a\xEF\xBF\xBD\"\n");
  EXPECT_EQ(writeJson(Value(std::numeric_limits<std::int64_t>::min())), "-9223372036854775808\n");
}

Value randomValue(test::Random& random, int depth) {
  switch (random.below(depth > 0 ? 8 : 6)) {
    case 0:
      return Value();
    case 1:
      return random.chance(0.5);
    case 2:
      return static_cast<std::int64_t>(random.next());
    case 3: {
      const std::uint64_t bits = random.next();
      double d = 0;
      std::memcpy(&d, &bits, sizeof d);
      return std::isfinite(d) ? d : 0.5;
    }
    case 4:
      return static_cast<double>(random.below(2000)) / 100 - 10;
    case 5: {
      constexpr std::string_view kPieces[] = {"a", "\"", "\\", "\n", "é", "数", "🌊", "\x01", "/", " "};
      std::string text;
      for (std::size_t n = random.below(12); n > 0; --n) text += random.pick(kPieces);
      return text;
    }
    case 6: {
      Value v = Value::array();
      for (std::size_t n = random.below(6); n > 0; --n) v.push(randomValue(random, depth - 1));
      return v;
    }
    default: {
      Value v = Value::object();
      for (std::size_t n = random.below(6); n > 0; --n)
        v["k" + std::to_string(n) + (random.chance(0.2) ? "\"é" : "")] = randomValue(random, depth - 1);
      return v;
    }
  }
}

TEST(WriteJson, WhatItWritesReadsBackEqual) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    test::Random random(seed);
    const Value v = randomValue(random, 5);
    const std::string text = writeJson(v);
    ASSERT_EQ(parse(text), v) << seed << "\n" << text;
    ASSERT_EQ(writeJson(parse(text)), text);
    const std::string line = writeJsonLine(v);
    ASSERT_EQ(parse(line), v) << seed << "\n" << line;
    ASSERT_EQ(line.find('\n'), line.size() - 1) << line;
  }
}

}  // namespace
}  // namespace weir
