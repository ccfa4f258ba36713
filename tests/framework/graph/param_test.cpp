// Every kind of parameter: what it takes, what it refuses, and how it is written.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "framework/base/check.h"
#include "framework/graph/configurable.h"
#include "framework/graph/type_values.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

using test::errorOf;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const Place kPlace{"s.json", "/p", "/scenes"};

Value list(std::initializer_list<Value> items) {
  return Value(Value::Array(items));
}

/// A node's parameter is assigned on its own; a refused value must leave the old one.
class ParamTest : public testing::Test {
 protected:
  void accepts(const char* name, const Value& v, const Value& reads) {
    Property& p = *source.findProperty(name);
    ASSERT_NO_THROW(p.assign(v, kPlace)) << name << " = " << v.brief();
    EXPECT_EQ(p.value(), reads) << name << " = " << v.brief() << " reads " << p.value().brief();
    EXPECT_TRUE(p.isSet());
  }
  void accepts(const char* name, const Value& v) { accepts(name, v, v); }
  Error refuses(const char* name, const Value& v) {
    Property& p = *source.findProperty(name);
    const Value before = p.value();
    const Error e = errorOf([&] { p.assign(v, kPlace); });
    EXPECT_EQ(p.value(), before) << name << " = " << v.brief();
    EXPECT_EQ(e.kind(), ErrorKind::kScene);
    EXPECT_EQ(e.location().parameter, name);
    EXPECT_EQ(e.location().pointer.substr(0, 2), "/p");
    EXPECT_FALSE(e.allowed().empty()) << e.what();
    return e;
  }

  test::Source source;
};

/// A parameter that means something under one choice only.
struct Tap final : Configurable {
  Param<TestShape> shape{*this, "shape", TestShape::kBox};
  Param<double> radius{
      *this, "radius", 1, {.doc = "How wide.", .onlyFor = "shape: sphere", .also = "width, size"}};
};

TEST(Condition, RefusesWhatMeansNothingUnderTheChoice) {
  Tap tap;
  Value given = Value::object();
  given["radius"] = 2;
  const Error e = errorOf([&] { tap.assignAll(given, kPlace); });
  EXPECT_CONTAINS(e.what(), "'radius' is given, which means nothing for the shape 'box'");
  EXPECT_CONTAINS(e.what(), "no radius, or as shape: sphere");
  EXPECT_EQ(e.location().pointer, "/p/radius");
  EXPECT_EQ(tap.radius, 1);
  given["shape"] = "sphere";
  tap.assignAll(given, kPlace);
  EXPECT_EQ(tap.radius, 2);
}

TEST(Condition, IsToldWithOtherWordsForTheParameter) {
  const Tap tap;
  const Value parameters = parametersAsValue(tap);
  const Value& radius = parameters.asArray().at(1);
  EXPECT_EQ(radius.find("only_for")->find("parameter")->asString(), "shape");
  EXPECT_EQ(*radius.find("only_for")->find("choices"), list({"sphere"}));
  EXPECT_EQ(*radius.find("also"), list({"width", "size"}));
  EXPECT_EQ(*tap.schema().find("properties")->find("radius")->find("description"),
            Value("How wide. Only for shape: sphere."));
}

TEST_F(ParamTest, Bool) {
  accepts("flag", true);
  for (const Value& bad : {Value(1), Value("true"), Value()}) refuses("flag", bad);
}

TEST_F(ParamTest, Integer) {
  accepts("count", 1);
  accepts("count", 100);
  accepts("count", 5.0, 5);
  for (const Value& bad : {Value(0), Value(101), Value(1.5), Value("3"), Value(true), Value(), Value(kNan),
                           Value(kInfinity), Value(1e300), Value(std::int64_t{1} << 40)})
    refuses("count", bad);
  EXPECT_CONTAINS(refuses("count", 0).what(), "found 0\n  allowed: an integer of at least 1 and at most 100");
}

TEST_F(ParamTest, LargeIntegerIsExact) {
  accepts("big", std::numeric_limits<std::int64_t>::max());
  accepts("big", std::numeric_limits<std::int64_t>::min());
  accepts("big", std::int64_t{9007199254740993});
  refuses("big", 1e18);  // a double that large may have lost its last digits
  refuses("big", 0.5);
}

TEST_F(ParamTest, Float) {
  accepts("speed", 0);
  accepts("speed", 0.1);
  accepts("speed", 3.4e38);
  for (const Value& bad :
       {Value(-1e-9), Value(1e39), Value(kNan), Value(kInfinity), Value("1"), Value(list({1}))})
    refuses("speed", bad);
  EXPECT_CONTAINS(refuses("speed", -1).allowed(), "[m/s]");
  EXPECT_CONTAINS(refuses("speed", 1e39).allowed(), "single precision");
}

TEST_F(ParamTest, DoubleAboveItsMinimum) {
  accepts("spacing", 5e-324);
  accepts("spacing", 1.7e308);
  for (const Value& bad : {Value(0), Value(-0.0), Value(-1), Value(kNan), Value(kInfinity)})
    refuses("spacing", bad);
  EXPECT_CONTAINS(refuses("spacing", 0).allowed(), "a number above 0");
}

TEST_F(ParamTest, ATinyNumberMayNotBecomeAForbiddenZero) {
  struct Holder : Configurable {
    Param<float> length{*this, "length", 1.0f, {.min = 0, .aboveMin = true}};
  } holder;
  EXPECT_THROW(holder.length.assign(1e-60, kPlace), Error);
  EXPECT_EQ(holder.length, 1.0f);
}

TEST_F(ParamTest, Vectors) {
  accepts("size", list({0, 2.5}));
  accepts("position", list({-1, 0, 1e3}));
  refuses("size", list({1}));
  refuses("size", list({1, 2, 3}));
  refuses("size", list({1, -1}));  // the range holds for each
  refuses("position", 1);
  refuses("position", Value(Value::Object{{"x", 1}}));
  EXPECT_EQ(refuses("position", list({1, "a", 3})).location().pointer, "/p/1");
  EXPECT_EQ(refuses("position", list({1, 2, kNan})).location().pointer, "/p/2");
}

TEST_F(ParamTest, Color) {
  accepts("color", list({0, 0.5, 1}));
  accepts("color", list({0, 0.5, 1, 0.25}));
  accepts("color", list({0, 0.5, 1, 1}), list({0, 0.5, 1}));
  accepts("color", "#ff0000", list({1, 0, 0}));
  accepts("color", "#00FF0000", list({0, 1, 0, 0}));
  for (const Value& bad :
       {Value("red"), Value("#ff00"), Value("#gg0000"), Value("ff0000"), Value("#ff00000"), list({0, 0}),
        list({0, 0, 2}), list({0, 0, -0.1}), list({0, 0, 0, 0, 0}), Value(1)})
    refuses("color", bad);
  EXPECT_CONTAINS(refuses("color", "red").allowed(), "#rrggbb");
}

TEST_F(ParamTest, Rotation) {
  accepts("rotation", list({0, 90, -720}));
  accepts("rotation", list({1, 0, 0, 0}));
  for (const Value& bad :
       {Value(90), list({0, 0}), list({1, 1, 0, 0}), list({0, 0, 0, 0}), list({kNan, 0, 0})})
    refuses("rotation", bad);
  EXPECT_CONTAINS(refuses("rotation", list({1, 1, 0, 0})).message(), "length 1.414");
  // A quaternion that is a little off has length 1 for those who turn by it.
  source.rotation.assign(list({0.0, 0.9995, 0.0, 0.0}), kPlace);
  EXPECT_NEAR(source.rotation->toQuaternion().x, 1, 1e-6);
}

TEST_F(ParamTest, Text) {
  accepts("label", "");
  accepts("label", "Tür 数");
  for (const Value& bad : {Value(1), Value(), Value(true)}) refuses("label", bad);
}

TEST_F(ParamTest, Path) {
  accepts("file", "a/b.obj");
  EXPECT_EQ(source.file->resolved, "/scenes/a/b.obj");
  accepts("file", "/a/b.obj");
  EXPECT_EQ(source.file->resolved, "/a/b.obj");
  accepts("file", "");
  EXPECT_TRUE(source.file->resolved.empty());
  refuses("file", 3);
  refuses("file", std::string("a\0b", 3));
}

TEST_F(ParamTest, Curve) {
  accepts("profile", list({list({0, 0}), list({1, 2})}));
  refuses("profile", list({list({0, 0})}));
  refuses("profile", Value());
  EXPECT_EQ(refuses("profile", list({list({0, 0}), list({1, "x"})})).location().pointer, "/p/1/1");
}

TEST_F(ParamTest, Enum) {
  accepts("shape", "plane");
  EXPECT_EQ(source.shape, TestShape::kPlane);
  const Error e = refuses("shape", "spehre");
  EXPECT_CONTAINS(e.allowed(), "\"box\", \"sphere\" or \"plane\"");
  EXPECT_CONTAINS(e.hint(), "sphere");
  refuses("shape", 1);
  EXPECT_EQ(source.shape.choices().size(), 3u);
}

TEST_F(ParamTest, OptionalAndList) {
  accepts("limit", 3.5);
  accepts("limit", Value());
  refuses("limit", -1);
  accepts("points", list({}));
  accepts("points", list({list({1, 2, 3})}));
  EXPECT_EQ(refuses("points", list({list({1, 2, 3}), list({1, 2})})).location().pointer, "/p/1");
  refuses("points", 1);
}

TEST_F(ParamTest, GroupsAreObjects) {
  accepts("start", Value(Value::Object{{"time", 2}}));
  accepts("path", list({Value(Value::Object{{"time", 2}}), Value::object()}));
  EXPECT_EQ(source.path.size(), 2u);
  EXPECT_EQ(errorOf([&] {
              source.start.assign(Value(Value::Object{{"tim", 1}}), kPlace);
            })
                .location()
                .pointer,
            "/p/tim");
  EXPECT_EQ(errorOf([&] {
              source.path.assign(list({Value(Value::Object{{"time", -1}})}), kPlace);
            })
                .location()
                .pointer,
            "/p/0/time");
  EXPECT_EQ(source.path.size(), 2u);
  Value::Array tooMany(10001, Value::object());
  refuses("path", tooMany);
}

TEST(Configurable, NamesAreUnique) {
  struct Twice : Configurable {
    Param<int> a{*this, "a", 1};
    Param<int> b{*this, "a", 2};
  };
  EXPECT_THROW(Twice(), InternalError);
}

TEST(Configurable, SettingFromAProgramIsCheckedToo) {
  test::Source source;
  source.count.set(9);
  EXPECT_EQ(source.count, 9);
  EXPECT_THROW(source.count.set(1000), Error);
  EXPECT_EQ(source.count, 9);
}

TEST(Configurable, UnknownNamesAreErrorsWithASuggestion) {
  test::Source source;
  Value v;
  v["positoin"] = 1;
  const Error e = errorOf([&] { source.assignAll(v, kPlace); });
  EXPECT_EQ(e.location().pointer, "/p/positoin");
  EXPECT_CONTAINS(e.hint(), "'position'");
  EXPECT_CONTAINS(e.allowed(), "spacing");
}

TEST(Configurable, AssignAllChangesAllOrNothing) {
  test::Source source;
  Value before;
  before["file"] = "a.obj";
  before["start"]["time"] = 1;
  before["path"] = list({Value(Value::Object{{"time", 7}})});
  source.assignAll(before, kPlace);

  // Each breaks at its last member, or in validate().
  std::vector<Value> broken(3);
  broken[0]["file"] = "b.obj";
  broken[0]["start"]["time"] = 2;
  broken[0]["path"] = Value::array();
  broken[0]["profile"] = list({list({0, 0}), list({1, 1})});  // its default is shorter than it may be
  broken[0]["speed"] = -1;
  broken[1]["speed"] = 3;
  broken[1]["nothing"] = 3;
  broken[2]["flag"] = true;
  broken[2]["count"] = 80;
  for (const Value& v : broken) {
    EXPECT_THROW(source.assignAll(v, kPlace), Error);
    EXPECT_EQ(source.changedValues(), before);
    EXPECT_EQ(source.file->resolved, "/scenes/a.obj");
    EXPECT_FALSE(source.speed.isSet());
    EXPECT_FALSE(source.profile.isSet());
    EXPECT_TRUE(source.start.isSet());
  }
  EXPECT_EQ(source.path.size(), 1u);
  EXPECT_EQ(source.path[0].time, 7);
}

TEST(Configurable, ChangedValuesReadBackEqual) {
  test::Source a, b;
  Value v;
  v["speed"] = 0.3;
  v["color"] = "#102030";
  v["limit"] = 2;
  v["rotation"] = list({1, 2, 3});
  a.assignAll(v, kPlace);
  b.assignAll(a.changedValues(), kPlace);
  EXPECT_EQ(a.changedValues(), b.changedValues());
  EXPECT_EQ(a.color.get(), b.color.get());
  EXPECT_EQ(a.changedValues().asObject().size(), 4u);
  EXPECT_EQ(test::Source().changedValues(), Value::object());
}

TEST(Configurable, SchemaDescribesEveryProperty) {
  const test::Source source;
  const Value schema = source.schema();
  EXPECT_EQ(*schema.find("additionalProperties"), Value(false));
  const Value& members = *schema.find("properties");
  EXPECT_EQ(members.asObject().size(), source.properties().size());
  EXPECT_EQ(
      *members.find("spacing"),
      Value(Value::Object{
          {"type", "number"}, {"exclusiveMinimum", 0}, {"description", "A length. [m]"}, {"default", 0.1}}));
  EXPECT_EQ(*members.find("count")->find("maximum"), Value(100));
  EXPECT_EQ(members.find("shape")->find("enum")->asArray().size(), 3u);
  EXPECT_EQ(*members.find("start")->find("properties")->find("time")->find("type"), Value("number"));
  EXPECT_EQ(*members.find("path")->find("items")->find("type"), Value("object"));
}

}  // namespace
}  // namespace weir
