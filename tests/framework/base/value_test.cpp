#include "framework/base/value.h"

#include <gtest/gtest.h>

#include "framework/base/check.h"
#include "framework/base/text.h"

namespace weir {
namespace {

TEST(Value, KnowsItsKind) {
  EXPECT_TRUE(Value().isNull());
  EXPECT_TRUE(Value(true).isBool());
  EXPECT_TRUE(Value(3).isInt() && Value(3).isNumber());
  EXPECT_TRUE(!Value(3.5).isInt() && Value(3.5).isNumber());
  EXPECT_TRUE(Value("x").isString());
  EXPECT_EQ(Value(Value::Array{}).kindName(), "an array");
  EXPECT_THROW(Value(3).asString(), InternalError);
}

TEST(Value, AFloatKeepsItsShortestDecimal) {
  EXPECT_EQ(Value(0.1f).asDouble(), 0.1);
  EXPECT_EQ(Value(-9.8f).asDouble(), -9.8);
  EXPECT_EQ(static_cast<float>(Value(1.0f / 3.0f).asDouble()), 1.0f / 3.0f);
}

TEST(Value, ComparesContentNotPlace) {
  Value a(1), b(1.0);
  a.line = 4;
  EXPECT_EQ(a, b);
  // As doubles these two are the same number.
  EXPECT_FALSE(Value(std::int64_t{9007199254740993}) == Value(std::int64_t{9007199254740992}));
  EXPECT_FALSE(Value("1") == Value(1));
}

TEST(Value, MembersAreMadeOnDemandInOrder) {
  Value v;
  v["b"] = 1;
  v["a"]["c"] = 2;
  EXPECT_EQ(v.asObject()[0].first, "b");
  EXPECT_EQ(v.find("a")->find("c")->asInt(), 2);
  EXPECT_EQ(v.find("z"), nullptr);
  EXPECT_EQ(Value(1).find("a"), nullptr);
}

TEST(Value, BriefTextIsShortAndPrintable) {
  EXPECT_EQ(Value("a\nb").brief(), "\"a\\nb\"");
  EXPECT_EQ(Value(Value::Array{1, 2.5, "x"}).brief(), "[1, 2.5, \"x\"]");
  EXPECT_EQ(Value(Value::Object{{"a", 1}}).brief(), "an object of 1 member");
  Value::Array many(100000, Value(12345));
  EXPECT_LT(Value(many).brief().size(), 80u);
  EXPECT_TRUE(isUtf8(Value(std::string(59, 'x') + "数数").brief()));
}

TEST(ClosestName, SuggestsTypingMistakesOnly) {
  const std::vector<std::string> names{"spacing", "speed", "position"};
  EXPECT_EQ(closestName("spacin", names), "spacing");
  EXPECT_EQ(closestName("Speed", names), "speed");
  EXPECT_EQ(closestName("psoition", names), "position");
  EXPECT_EQ(closestName("viscosity", names), "");
  EXPECT_EQ(closestName(std::string(100000, 'x'), names), "");
  EXPECT_EQ(didYouMean("spacin", names), "did you mean 'spacing'?");
  EXPECT_EQ(didYouMean("viscosity", names), "");
}

TEST(JoinNames, ReadsAsASentence) {
  EXPECT_EQ(joinNames({}), "");
  EXPECT_EQ(joinNames({"a"}), "a");
  EXPECT_EQ(joinNames({"a", "b", "c"}), "a, b or c");
}

}  // namespace
}  // namespace weir
