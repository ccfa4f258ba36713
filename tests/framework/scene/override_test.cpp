#include <gtest/gtest.h>

#include <filesystem>

#include "framework/scene/scene_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

using test::errorOf;

TEST(ParseOverride, SplitsPathAndValue) {
  const Override o = parseOverride("water.solver.iterations=5");
  EXPECT_EQ(o.path, (std::vector<std::string>{"water", "solver", "iterations"}));
  EXPECT_EQ(o.value, Value(5));
  EXPECT_EQ(o.value.origin->name, "--set water.solver.iterations=5");
}

TEST(ParseOverride, TheValueIsJsonOrElseText) {
  const auto value = [](const std::string& text) { return parseOverride("a.b=" + text).value; };
  EXPECT_EQ(value("0.5"), Value(0.5));
  EXPECT_EQ(value("true"), Value(true));
  EXPECT_EQ(value("null"), Value());
  EXPECT_EQ(value("[1, 2]"), Value(Value::Array{1, 2}));
  EXPECT_EQ(value("{\"x\": 1}"), Value(Value::Object{{"x", 1}}));
  EXPECT_EQ(value("\"5\""), Value("5"));
  EXPECT_EQ(value("mesh.obj"), Value("mesh.obj"));
  EXPECT_EQ(value("3d/mesh.obj"), Value("3d/mesh.obj"));
  EXPECT_EQ(value("a=b"), Value("a=b"));
  EXPECT_EQ(value(""), Value(""));
  EXPECT_EQ(parseOverride("title=A = B").value, Value("A = B"));
}

TEST(ParseOverride, SaysWhatTheFormIs) {
  for (const std::string text : {"", "a", "a.b", "=1", "a=1", "a.=1", ".b=1", "a..b=1", "world=1", "a.b=[1",
                                 "a.b={x}", "a.b=\"x", "\xFF.b=1"}) {
    const Error e = errorOf([&] { parseOverride(text); });
    EXPECT_EQ(e.kind(), ErrorKind::kUsage) << text;
    EXPECT_CONTAINS(e.what(), "--set ");
    EXPECT_FALSE(e.allowed().empty()) << text;
  }
}

class OverrideTest : public testing::Test {
 protected:
  OverrideTest() { test::registerTestTypes(registry); }

  std::unique_ptr<Scene> build(const std::vector<std::string>& settings,
                               std::string_view text = test::kTestScene) {
    std::vector<Override> overrides;
    for (const std::string& setting : settings) overrides.push_back(parseOverride(setting));
    warnings.clear();
    return buildScene(parseJson(text, "s.json"), {"s.json", "", "/scenes"}, registry, overrides, warnings);
  }
  Error error(const std::string& setting) {
    return errorOf([&] { build({setting}); });
  }
  const test::Source& source(const Scene& scene, const char* name) {
    return dynamic_cast<const test::Source&>(*scene.graph.find(name));
  }

  Registry registry;
  std::vector<std::string> warnings;
};

TEST_F(OverrideTest, ReachesEveryPartOfAScene) {
  const auto scene =
      build({"a.speed=7", "b.spacing=0.25", "a.start.time=9", "a.path.1.time=3", "world.dt=0.5",
             "title=Other", "worker.scale.factor=3", "worker.more.factor=4", "worker.extra.amount=2",
             "stage.width=100", "stage.camera.position=[4,5,6]", "stage.keyframes.0.time=8",
             "render.camera.eye=[9,9,9]", "b.speed=1", "b.speed=2"});
  EXPECT_EQ(source(*scene, "a").speed, 7);
  EXPECT_EQ(source(*scene, "b").spacing, 0.25);
  EXPECT_EQ(source(*scene, "b").speed, 2);  // the later one
  EXPECT_EQ(source(*scene, "a").start->time, 9);
  EXPECT_EQ(source(*scene, "a").path[1].time, 3);
  EXPECT_EQ(source(*scene, "a").path[0].position.get(), (Vec3f{1, 0, 0}));
  EXPECT_EQ(scene->world.dt, 0.5);
  EXPECT_EQ(scene->title, "Other");
  EXPECT_EQ(dynamic_cast<test::Worker&>(*scene->graph.find("worker")).result(10), 10 * 4 * 3 + 1 + 2);
  const auto& stage = dynamic_cast<const test::Stage&>(*scene->sections.at("stage"));
  EXPECT_EQ(stage.width, 100);
  EXPECT_EQ(stage.camera->position.get(), (Vec3f{4, 5, 6}));
  EXPECT_EQ(stage.keyframes[0].time, 8);
  EXPECT_EQ(*scene->unknownSections.at("render").find("camera")->find("eye"), Value(Value::Array{9, 9, 9}));
}

TEST_F(OverrideTest, MakesWhatTheFileLeavesOut) {
  constexpr std::string_view kSmall =
      R"({"weir": 1, "nodes": {"f": {"type": "NeedsFile"}, "s": {"type": "Source"},
    "w": {"type": "Worker"}}, "links": ["s.number -> w.in"]})";
  const auto scene =
      build({"f.file=/x.txt", "w.scale.factor=3", "world.duration=1", "stage.camera.time=1"}, kSmall);
  EXPECT_EQ(dynamic_cast<const test::NeedsFile&>(*scene->graph.find("f")).file->text, "/x.txt");
  EXPECT_EQ(dynamic_cast<test::Worker&>(*scene->graph.find("w")).result(1), 6);
  EXPECT_EQ(scene->world.duration, 1);
}

TEST_F(OverrideTest, ReachesTheTypeOfAModuleAndWhetherItRuns) {
  const auto result = [&](const std::vector<std::string>& settings) {
    return dynamic_cast<test::Worker&>(*build(settings)->graph.find("worker")).result(10);
  };
  EXPECT_EQ(result({}), 10 * 0.5 * 2 + 1 + 1);
  EXPECT_EQ(result({"worker.scale.enabled=false"}), 10 * 0.5 + 1 + 1);
  EXPECT_EQ(result({"worker.extra.type=ScaleRule"}), (10 * 0.5 * 2 + 1) * 2);
  EXPECT_CONTAINS(error("worker.scale.type=Stranger").what(), "Stranger");
  EXPECT_CONTAINS(error("worker.scale.enabled=3").what(), "--set worker.scale.enabled=3");
}

TEST_F(OverrideTest, PathsAreRelativeToTheCurrentFolder) {
  const std::filesystem::path here = std::filesystem::current_path();
  const auto scene = build({"a.file=my.obj", "b.files=[\"one.obj\", \"/two.obj\"]"});
  EXPECT_EQ(source(*scene, "a").file->resolved, here / "my.obj");
  EXPECT_EQ(source(*scene, "b").files->at(0).resolved, here / "one.obj");
  EXPECT_EQ(source(*scene, "b").files->at(1).resolved, "/two.obj");
  // Those of the file stay relative to it, and a scene that is written leads to the same files.
  EXPECT_EQ(source(*scene, "a").files->at(0).resolved, "/scenes/x.obj");
  EXPECT_EQ(source(*build({}, writeJson(sceneToValue(*scene))), "a").file->resolved, here / "my.obj");
}

TEST_F(OverrideTest, ErrorsNameTheOption) {
  Error e = error("a.spacing=-1");
  EXPECT_EQ(e.kind(), ErrorKind::kScene);
  EXPECT_STREQ(e.what(),
               "--set a.spacing=-1: /nodes/a/params/spacing: node 'a': parameter 'spacing': found -1\n"
               "  allowed: a number above 0 [m]");
  e = error("a.sped=1");
  EXPECT_CONTAINS(e.what(), "--set a.sped=1: /nodes/a/params/sped: node 'a': there is no parameter 'sped'");
  EXPECT_CONTAINS(e.hint(), "'speed'");
  e = error("worker.scale.facto=1");
  EXPECT_CONTAINS(e.what(), "--set worker.scale.facto=1: /nodes/worker/modules/scale/params/facto");
  e = error("a.position=[1, 2]");
  EXPECT_CONTAINS(e.what(), "--set a.position=[1, 2]");
  e = error("a.position=[1, 2, \"x\"]");
  EXPECT_CONTAINS(e.what(), "/nodes/a/params/position/2");
  EXPECT_CONTAINS(error("world.dt=nan").what(),
                  "--set world.dt=nan: /world/dt: parameter 'dt': found \"nan\"");
  EXPECT_CONTAINS(error("title=3").what(), "--set title=3: /title: found 3");
}

TEST_F(OverrideTest, UnknownTargetsAreErrorsWithASuggestion) {
  Error e = error("wrker.scale.factor=1");
  EXPECT_CONTAINS(e.what(), "--set wrker.scale.factor=1: the scene has no node 'wrker'");
  EXPECT_CONTAINS(e.allowed(), "relay");
  EXPECT_CONTAINS(e.hint(), "'worker'");
  e = error("worker.scal.factor=1");
  EXPECT_CONTAINS(e.what(), "'worker' (Worker) has no module 'scal'");
  EXPECT_CONTAINS(e.hint(), "'scale'");
  e = error("b.strat.time=1");
  EXPECT_CONTAINS(e.hint(), "'start'");
  EXPECT_CONTAINS(error("stage.keyframes.2.time=1").what(), "the list has no element '2'");
  EXPECT_CONTAINS(error("stage.keyframes.x.time=1").allowed(), "0 to 1");
  EXPECT_CONTAINS(error("a.speed.x=1").what(), "--set a.speed.x=1: 'x' cannot be set in what is 0.1");
  EXPECT_CONTAINS(error("title.x=1").what(), "the title has no parameters");
}

TEST_F(OverrideTest, AnErrorInTheFileIsStillTheFilesError) {
  constexpr std::string_view kBroken = R"({"weir": 1, "nodes": {"a": {"type": "Sorce"}}})";
  const Error e = errorOf([&] { build({"a.start.time=1"}, kBroken); });
  EXPECT_CONTAINS(e.what(), "s.json:1:37: /nodes/a/type: node 'a': there is no node type 'Sorce'");
  EXPECT_CONTAINS(errorOf([&] { build({"a.b=1"}, "[]"); }).what(), "s.json:1:1");
  EXPECT_CONTAINS(errorOf([&] { build({"a.b=1"}, R"({"weir": 1})"); }).what(), "no node 'a'");
}

}  // namespace
}  // namespace weir
