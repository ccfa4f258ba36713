// What scene files may have beyond plain JSON: comments, variables, expressions, units, includes, repetition
// and notes.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "framework/scene/scene_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

namespace fs = std::filesystem;
using test::errorOf;

class WrittenFormTest : public testing::Test {
 protected:
  WrittenFormTest() {
    test::registerTestTypes(registry);
    fs::remove_all(folder);
    fs::create_directories(folder / "parts");
  }
  ~WrittenFormTest() override { fs::remove_all(folder); }

  std::unique_ptr<Scene> build(std::string_view text, const std::vector<std::string>& settings = {}) {
    std::vector<Override> overrides;
    for (const std::string& setting : settings) overrides.push_back(parseOverride(setting));
    return buildScene(parseScene(text, "s.json"), {"s.json", "", folder.string()}, registry, overrides,
                      warnings);
  }
  std::unique_ptr<Scene> load(const std::vector<std::string>& settings = {}) {
    std::vector<Override> overrides;
    for (const std::string& setting : settings) overrides.push_back(parseOverride(setting));
    return loadScene(folder / "scene.json", registry, overrides, warnings);
  }
  /// A scene of one source with these parameters; more members of the scene before it.
  static std::string source(const std::string& params, const std::string& before = {}) {
    return "{\"weir\": 1, " + before + "\"nodes\": {\"a\": {\"type\": \"Source\", \"params\": {" + params +
           "}}}}";
  }
  const test::Source& sourceOf(const Scene& scene, const std::string& name = "a") {
    return dynamic_cast<const test::Source&>(*scene.graph.find(name));
  }
  double spacingOf(const std::string& expression, const std::string& let = "{}") {
    const auto scene = build(source("\"spacing\": \"=" + expression + "\"", "\"let\": " + let + ", "));
    return sourceOf(*scene).spacing;
  }
  Error error(const std::string& text) {
    return errorOf([&] { build(text); });
  }
  Error errorInSpacing(const std::string& expression, const std::string& let = "{}") {
    return errorOf([&] { spacingOf(expression, let); });
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder / name) << text; }

  fs::path folder =
      fs::path(testing::TempDir()) /
      ("weir_form_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  Registry registry;
  std::vector<std::string> warnings;
};

TEST(ParseScene, CommentsAndTrailingCommasAreBlanks) {
  const Value v = parseScene(
      "// first\n{ /* é */ \"a\": [1, 2,], // ]\n  \"b\": {\"c\": \"// no /* , ]\",},\n}\n/**/", "s.json");
  EXPECT_EQ(v, parseJson(R"({"a": [1, 2], "b": {"c": "// no /* , ]"}})", "t"));
  EXPECT_EQ(v.line, 2);
  EXPECT_EQ(v.find("a")->column, 16);  // a column is a character, in comments too
  EXPECT_EQ(v.find("b")->line, 3);
}

TEST(ParseScene, ATrailingCommaMayHaveCommentsBehindIt) {
  EXPECT_EQ(parseScene("[\"x\\\"\", /* a */ // b\n ]", "s"), parseJson(R"(["x\""])", "t"));
}

TEST(ParseScene, OtherMistakesKeepTheirPlaces) {
  const auto refused = [](std::string_view text) {
    return std::string(errorOf([&] { parseScene(text, "s.json"); }).what());
  };
  EXPECT_CONTAINS(refused("/* é\n */ [1,,]"), "s.json:2:8: found ','");
  EXPECT_CONTAINS(refused("[,]"), "s.json:1:2: found ','");
  EXPECT_CONTAINS(refused("{\"a\":,}"), "s.json:1:6: found ','");
  EXPECT_CONTAINS(refused("{}\n /* x"), "s.json:2:2: the comment does not end");
  EXPECT_CONTAINS(refused("[1 / 2]"), "s.json:1:4: found '/ '");
  EXPECT_CONTAINS(refused("// only"), "the file is empty");
  EXPECT_CONTAINS(refused("# x\n{}"), "// and /* */");
}

TEST_F(WrittenFormTest, ExpressionsFollowTheRulesOfArithmetic) {
  EXPECT_EQ(spacingOf("1 + 2*3"), 7);
  EXPECT_EQ(spacingOf("(1 + 2)*3"), 9);
  EXPECT_EQ(spacingOf("10 - 4 - 3"), 3);
  EXPECT_EQ(spacingOf("16/4/2"), 2);
  EXPECT_EQ(spacingOf("2^3^2"), 512);
  EXPECT_EQ(spacingOf("20 - 2^2"), 16);
  EXPECT_EQ(spacingOf("5 + -2^2"), 1);
  EXPECT_EQ(spacingOf("2^-1"), 0.5);
  EXPECT_EQ(spacingOf("--3"), 3);
  EXPECT_EQ(spacingOf("1.5e-2"), 0.015);
  EXPECT_EQ(spacingOf("sqrt(16) + abs(-1) + floor(1.7) + ceil(1.2) + round(2.5)"), 11);
  EXPECT_EQ(spacingOf("min(3, 1, 2) + max(3, 1, 2)"), 4);
  EXPECT_EQ(spacingOf("pi"), 3.141592653589793);
}

TEST_F(WrittenFormTest, AnglesOfFunctionsAreInDegrees) {
  EXPECT_EQ(spacingOf("1 + sin(180)"), 1);
  EXPECT_EQ(spacingOf("sin(30)"), 0.5);
  EXPECT_EQ(spacingOf("sin(90) + cos(360)"), 2);
  EXPECT_EQ(spacingOf("2 + sin(-90)"), 1);
  EXPECT_EQ(spacingOf("cos(-60)"), 0.5);
  EXPECT_EQ(spacingOf("tan(45)"), 1);
  EXPECT_NEAR(spacingOf("sin(20)"), 0.3420201433256687, 1e-15);
  EXPECT_CONTAINS(errorInSpacing("tan(90)").what(), "tan(90) is infinite");
}

TEST_F(WrittenFormTest, VariablesMayNameEachOtherInAnyOrder) {
  EXPECT_EQ(spacingOf("c", R"({"c": "=a*b", "a": "=2*b", "b": 0.5})"), 0.5);
}

TEST_F(WrittenFormTest, ExpressionsStandForAnyNumber) {
  const auto scene = build(source(R"("count": "=20*n", "size": ["=n", "=n+1"], "start": {"time": "=n/4"},
                                     "path": [{"position": [0, "=-n", 0]}])",
                                  R"("let": {"n": 2}, "world": {"duration": "=n*3"}, )"));
  EXPECT_EQ(sourceOf(*scene).count, 40);
  EXPECT_EQ(sourceOf(*scene).size.get(), (Vec2f{2, 3}));
  EXPECT_EQ(sourceOf(*scene).start->time, 0.5);
  EXPECT_EQ(sourceOf(*scene).path[0].position->y, -2);
  EXPECT_EQ(scene->world.duration, 6);
}

TEST_F(WrittenFormTest, MistakesInExpressionsNameTheirPlace) {
  const std::string let = R"({"spacing": 0.1})";
  const auto refused = [&](const char* e) { return std::string(errorInSpacing(e, let).what()); };
  EXPECT_CONTAINS(refused("spacng*2"), "s.json:1:94: /nodes/a/params/spacing");
  EXPECT_CONTAINS(refused("spacng*2"), "names 'spacng', which there is not");
  EXPECT_CONTAINS(refused("spacng*2"), "did you mean 'spacing'?");
  EXPECT_CONTAINS(refused("1/0"), "divides by zero");
  EXPECT_CONTAINS(refused("0^-1"), "divides by zero");
  EXPECT_CONTAINS(refused("1/(spacing - spacing)"), "divides by zero");
  EXPECT_CONTAINS(refused("sqrt(-1)"), "sqrt(-1) is not a real number");
  EXPECT_CONTAINS(refused("(0-8)^0.5"), "is not a real number");
  EXPECT_CONTAINS(refused("10^400"), "is infinite");
  EXPECT_CONTAINS(refused("1e400"), "does not fit");
  EXPECT_CONTAINS(refused("1 +"), "ends too early");
  EXPECT_CONTAINS(refused(""), "ends too early");
  EXPECT_CONTAINS(refused("(1"), "ends too early");
  EXPECT_CONTAINS(refused("1 $ 2"), "has '$' at character 4");
  EXPECT_CONTAINS(refused("2 spacing"), "has 's' at character 4");
  EXPECT_CONTAINS(refused("2spacing"), "right behind a number");
  EXPECT_CONTAINS(refused("sqrt"), "ends too early");
  EXPECT_CONTAINS(refused("sqrt(1, 2)"), "gives sqrt 2 arguments");
  EXPECT_CONTAINS(refused("min()"), "a number, a name or '('");
  EXPECT_CONTAINS(refused((std::string(50, '(') + "1" + std::string(50, ')')).c_str()), "nested too deeply");
  EXPECT_CONTAINS(refused((std::string(100, '-') + "1").c_str()), "nested too deeply");
  EXPECT_CONTAINS(refused(("1" + std::string(1000, '0')).c_str()), "characters");
  EXPECT_CONTAINS(error(source("\"count\": \"=9/2\"")).what(),
                  "/nodes/a/params/count: node 'a': parameter 'count'");
  EXPECT_CONTAINS(error(source("\"count\": \"=9/2\"")).what(), "found 4.5");
}

TEST_F(WrittenFormTest, MistakesInVariablesNameTheirPlace) {
  EXPECT_CONTAINS(errorInSpacing("1", R"({"a": "=b", "b": "=c+1", "c": "=b"})").what(),
                  "/let/b: the variables depend on each other: b -> c -> b");
  EXPECT_CONTAINS(errorInSpacing("1", R"({"a": "=a"})").what(), "a -> a");
  EXPECT_CONTAINS(errorInSpacing("1", R"({"a": "=x"})").what(), "/let/a: the expression '=x' names 'x'");
  EXPECT_CONTAINS(errorInSpacing("1", R"({"sin": 1})").what(), "/let/sin: 'sin' cannot name a variable");
  EXPECT_CONTAINS(errorInSpacing("1", R"({"a b": 1})").what(), "'a b' cannot name a variable");
  EXPECT_CONTAINS(errorInSpacing("1", R"({"a": true})").what(), "/let/a: found true");
  EXPECT_CONTAINS(errorInSpacing("1", "[1]").what(), "/let: found [1]");
  std::string chain = "{\"v0\": 1";
  for (int i = 1; i < 200; ++i)
    chain += ", \"v" + std::to_string(200 - i) + "\": \"=v" + std::to_string(199 - i) + "\"";
  EXPECT_CONTAINS(errorInSpacing("1", chain + "}").what(), "too long");
}

TEST_F(WrittenFormTest, OptionsSetVariablesAndMayNameThem) {
  const std::string text = source("\"spacing\": \"=s*2\"", R"("let": {"s": 0.1, "t": "=s*10"}, )");
  EXPECT_EQ(sourceOf(*build(text, {"let.s=0.25"})).spacing, 0.5);
  EXPECT_EQ(sourceOf(*build(text, {"let.s==t/4", "let.t=2"})).spacing, 1);
  EXPECT_EQ(sourceOf(*build(text, {"a.speed==t*3"})).speed, 3);
  const Error e = errorOf([&] { build(text, {"let.sx=1"}); });
  EXPECT_CONTAINS(e.what(), "--set let.sx=1");
  EXPECT_CONTAINS(e.what(), "no variable");
  EXPECT_CONTAINS(e.what(), "s or t");
  EXPECT_CONTAINS(errorOf([&] { build(source(""), {"let.s=1"}); }).what(), "it has no \"let\"");
  EXPECT_CONTAINS(errorOf([&] { build(text, {"let.s=[1]"}); }).what(), "--set let.s=[1]");
}

TEST_F(WrittenFormTest, TextsThatBeginWithAnEqualsSignAreWrittenWithTwo) {
  const auto scene = build(source("\"label\": \"==a\""));
  EXPECT_EQ(sourceOf(*scene).label.get(), "=a");
  const Value written = sceneToValue(*scene);
  EXPECT_EQ(sourceOf(*build(writeJson(written))).label.get(), "=a");
  EXPECT_EQ(build(source("", R"("title": "=1+1", )"))->title, "=1+1");
}

TEST_F(WrittenFormTest, UnitsAreConverted) {
  const auto scene = build(source(R"("spacing": "7 cm", "speed": "36km/h", "size": ["10 mm", 2],
      "position": ["1 km", "-2.5e1 cm", 3], "start": {"time": "2 min"}, "rotation": ["90 deg", "1 rev", 0])",
                                  R"("world": {"dt": "0.3 ms", "frame_rate": "50 Hz"}, )"));
  EXPECT_EQ(sourceOf(*scene).spacing, 0.07);
  EXPECT_EQ(sourceOf(*scene).speed, 10);
  EXPECT_EQ(sourceOf(*scene).size.get(), (Vec2f{0.01f, 2}));
  EXPECT_EQ(sourceOf(*scene).position.get(), (Vec3f{1000, -0.25f, 3}));
  EXPECT_EQ(sourceOf(*scene).start->time, 120);
  EXPECT_EQ(sourceOf(*scene).rotation->degrees, (Vec3f{90, 360, 0}));
  EXPECT_EQ(scene->world.dt, 0.0003);
  EXPECT_EQ(scene->world.frameRate, 50);
}

TEST_F(WrittenFormTest, UnitsThatDoNotFitAreRefused) {
  const auto refused = [&](const std::string& params) { return std::string(error(source(params)).what()); };
  EXPECT_CONTAINS(refused(R"("spacing": "5 s")"), "found \"5 s\", which cannot be converted to m");
  EXPECT_CONTAINS(refused(R"("spacing": "5 s")"), "m, cm, mm or km");
  EXPECT_CONTAINS(refused(R"("spacing": "5 cn")"), "the unit 'cn' is not known");
  EXPECT_CONTAINS(refused(R"("spacing": "5 cm^x")"), "is not known");
  EXPECT_CONTAINS(refused(R"("spacing": "5")"), "found \"5\"");
  EXPECT_CONTAINS(refused(R"("spacing": "-5 cm")"), "a number above 0 [m]");
  EXPECT_CONTAINS(refused(R"("count": "5 cm")"), "this parameter has no unit");
  EXPECT_CONTAINS(refused(R"("rotation": ["1 m", 0, 0])"), "cannot be converted to degrees");
}

TEST_F(WrittenFormTest, CompoundUnitsAreConverted) {
  const auto gravity = [&](const std::string& unit) {
    return build(source("", R"("world": {"gravity": [0, "1 )" + unit + R"(", 0]}, )"))->world.gravity->y;
  };
  EXPECT_EQ(gravity("m/s^2"), 1);
  EXPECT_EQ(gravity("cm/s^2"), 0.01f);
  EXPECT_EQ(gravity("m s^-2"), 1);
  EXPECT_EQ(gravity("mm/ms/s"), 1);
  EXPECT_EQ(gravity("N/kg"), 1);
  EXPECT_EQ(gravity("J/g/m"), 1000);
}

TEST_F(WrittenFormTest, FilesAreMergedBelowTheMembersBesideThem) {
  write("base.json", R"({"weir": 1, "let": {"s": 0.1}, "nodes": {"a": {"$include": "parts/a.json",
      "params": {"count": 7}}}, /* c */ "world": {"duration": 2, "dt": 0.002},})");
  write("parts/a.json", R"({"type": "Source", "params": {"count": 9, "spacing": "=s*2", "file": "x.txt"}})");
  write("scene.json", R"({"$include": "base.json", "let": {"s": 0.3}, "world": {"duration": 5}})");
  const auto scene = load();
  EXPECT_EQ(scene->world.duration, 5);
  EXPECT_EQ(scene->world.dt, 0.002);
  EXPECT_EQ(sourceOf(*scene).count, 7);
  EXPECT_EQ(sourceOf(*scene).spacing, 0.6);
  EXPECT_EQ(sourceOf(*scene).file->resolved, folder / "parts/x.txt");
  EXPECT_EQ(sourceOf(*scene).file->text, "parts/x.txt");
}

TEST_F(WrittenFormTest, MistakesInIncludedFilesNameThem) {
  write("scene.json", R"({"weir": 1, "nodes": {"a": {"$include": "parts/a.json"}}})");
  write("parts/a.json", "{\"type\": \"Source\",\n \"params\": {\"count\": 1000}}");
  EXPECT_CONTAINS(errorOf([&] { load(); }).what(), "parts/a.json:2:22: /nodes/a/params/count");
  write("parts/a.json", "{\n 1}");
  EXPECT_CONTAINS(errorOf([&] { load(); }).what(), "parts/a.json:2:2: found '1'");
}

TEST_F(WrittenFormTest, OnlyFilesBelowTheSceneAreIncluded) {
  const auto refused = [&](const std::string& file) {
    return std::string(error(R"({"weir": 1, "$include": ")" + file + "\"}").what());
  };
  write("parts/up.json", R"({"$include": "../base.json"})");
  write("base.json", R"({"$include": "parts/up.json"})");
  write("list.json", "[1]");
  write("self.json", R"({"$include": "self.json"})");
  fs::create_symlink(fs::temp_directory_path(), folder / "link");
  std::ofstream(fs::temp_directory_path() / "weir_outside.json") << "{}";
  EXPECT_CONTAINS(refused("../x.json"), "s.json:1:25: /$include: the file '../x.json' is outside the folder");
  EXPECT_CONTAINS(refused("parts/../../x.json"), "outside");
  EXPECT_CONTAINS(refused("/etc/passwd"), "outside");
  EXPECT_CONTAINS(refused("link/weir_outside.json"), "leads outside");
  EXPECT_CONTAINS(refused("absent.json"), "there is no file 'absent.json'");
  EXPECT_CONTAINS(refused("parts"), "there is no file");
  EXPECT_CONTAINS(refused("list.json"), "holds [1]");
  EXPECT_CONTAINS(refused("base.json"), "include each other: base.json -> parts/up.json -> base.json");
  EXPECT_CONTAINS(refused("self.json"), "self.json -> self.json");
  EXPECT_CONTAINS(refused(""), "found \"\"");
  fs::remove(fs::temp_directory_path() / "weir_outside.json");
}

TEST_F(WrittenFormTest, ManyIncludesEnd) {
  for (int i = 0; i < 20; ++i) {
    const std::string next = "{\"$include\": \"f" + std::to_string(i + 1) + ".json\"}";
    write("f" + std::to_string(i) + ".json", "{\"a\": " + next + ", \"b\": " + next + "}");
  }
  write("f20.json", "{}");
  EXPECT_CONTAINS(error(R"({"weir": 1, "x": {"$include": "f0.json"}})").what(), "too many files");
}

TEST_F(WrittenFormTest, NodesAndLinksAreRepeated) {
  const auto scene = build(R"({"weir": 1, "let": {"n": 3}, "nodes": {
      "s_{i+1}": {"repeat": "=n", "note": "copies", "node": {"type": "Source",
          "params": {"count": "=10*i + 1", "label": "of {n}: {i}", "path": [
            {"repeat": 2, "as": "k", "item": {"time": "=i + k/2"}}, {"time": 9}]}}},
      "sum": {"type": "Sum"}},
    "links": [{"repeat": "=n", "as": "k", "item": "s_{k + 1}.number -> sum.terms"}]})");
  ASSERT_EQ(scene->graph.nodes().size(), 4u);
  EXPECT_EQ(scene->graph.links().size(), 3u);
  const test::Source& last = sourceOf(*scene, "s_3");
  EXPECT_EQ(last.count, 21);
  EXPECT_EQ(last.label.get(), "of 3: 2");
  ASSERT_EQ(last.path.size(), 3u);
  EXPECT_EQ(last.path[1].time, 2.5);
  EXPECT_EQ(last.path[2].time, 9);
}

TEST_F(WrittenFormTest, RepeatedNodesCanBeSetByOptions) {
  const auto scene =
      build(R"({"weir": 1, "nodes": {"s{i}": {"repeat": 2, "node": {"type": "Source"}}}})", {"s1.count=5"});
  EXPECT_EQ(sourceOf(*scene, "s0").count, 3);
  EXPECT_EQ(sourceOf(*scene, "s1").count, 5);
}

TEST_F(WrittenFormTest, RepetitionsAreChecked) {
  const auto refused = [&](const std::string& name, const std::string& repetition) {
    return std::string(error("{\"weir\": 1, \"nodes\": {\"" + name + "\": " + repetition + "}}").what());
  };
  const std::string body = R"("node": {"type": "Source"}})";
  EXPECT_CONTAINS(refused("s", "{\"repeat\": 2, " + body), "there are two nodes 's'");
  EXPECT_CONTAINS(refused("s{j}", "{\"repeat\": 2, " + body), "names 'j', which there is not");
  EXPECT_CONTAINS(refused("s{i/2}", "{\"repeat\": 2, " + body), "'{i/2}' is 0.5");
  EXPECT_CONTAINS(refused("s{i}", "{\"repeat\": -1, " + body), "/nodes/s{i}/repeat: found -1");
  EXPECT_CONTAINS(refused("s{i}", "{\"repeat\": \"=3/2\", " + body), "found \"=3/2\", which is 1.5");
  EXPECT_CONTAINS(refused("s{i}", "{\"repeat\": 1e9, " + body), "from 0 to 100000");
  EXPECT_CONTAINS(refused("s{i}", "{\"repeat\": 2, \"as\": 3, " + body), "as the name of the index");
  EXPECT_CONTAINS(refused("s{i}", "{\"repeat\": 2, \"at\": 3, " + body), "no member 'at'");
  EXPECT_CONTAINS(refused("s{i}", "{\"repeat\": 2}"), "has no \"node\"");
  EXPECT_CONTAINS(refused("s{i}", "{\"repeat\": 5000, " + body), "5000 nodes");
  EXPECT_CONTAINS(refused("s{i}", R"({"repeat": 1000, "node": {"type": "Source", "params": {"points": [
        {"repeat": 100000, "as": "k", "item": [0, 0, 0]}]}}})"),
                  "too many values");
}

TEST_F(WrittenFormTest, NotesAreIgnored) {
  const auto scene = build(R"({"weir": 1, "note": "a", "world": {"note": "b", "duration": 1},
      "let": {"note": "c", "x": 1},
      "nodes": {"note": "d", "a": {"type": "Source", "note": "e", "params": {"note": "f", "start": {"note": "g"}}},
                "w": {"type": "Worker", "modules": {"note": "h", "scale": {"note": "i"}}}},
      "links": ["a.number -> w.in"]})");
  EXPECT_EQ(scene->graph.nodes().size(), 2u);
}

TEST_F(WrittenFormTest, TextThatIsKeptIsPlain) {
  const std::string plain = source("\"count\": 7, \"spacing\": 0.05");
  const auto kept = [&](const std::string& text, const std::vector<std::string>& settings = {}) {
    write("scene.json", text);
    return load(settings)->text;
  };
  EXPECT_EQ(kept(plain), plain);
  EXPECT_EQ(kept(plain, {"a.count=3"}), plain);
  write("parts/count.json", R"({"count": 7, "spacing": 0.05})");
  for (const std::string& text :
       {source("\"count\": 7, /* */ \"spacing\": 0.05"), source("\"count\": 7, \"spacing\": 0.05,"),
        source("\"count\": \"=n\", \"spacing\": 0.05", "\"let\": {\"n\": 7}, "),
        source("\"count\": 7, \"spacing\": \"5 cm\""), source("\"$include\": \"parts/count.json\""),
        source("\"count\": 7, \"spacing\": 0.05, \"note\": \"n\"")})
    EXPECT_EQ(parseJson(kept(text), "kept"), parseJson(plain, "plain")) << text;
  EXPECT_EQ(
      parseJson(kept(source("\"count\": \"=n\", \"spacing\": 0.05", "\"let\": {\"n\": 1}, "), {"let.n=7"}),
                "k"),
      parseJson(plain, "plain"));
}

}  // namespace
}  // namespace weir
