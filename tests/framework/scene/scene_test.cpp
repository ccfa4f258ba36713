// Reading and writing of whole scenes.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "framework/scene/scene_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

using test::errorOf;

class SceneTest : public testing::Test {
 protected:
  SceneTest() { test::registerTestTypes(registry); }

  std::unique_ptr<Scene> build(std::string_view text, const std::vector<Override>& overrides = {}) {
    warnings.clear();
    return buildScene(parseJson(text, "s.json"), {"s.json", "", "/scenes"}, registry, overrides, warnings);
  }
  /// The error of a scene whose nodes are `nodes`.
  Error nodesError(const std::string& nodes) {
    return errorOf([&] { build("{\"weir\": 1,\n\"nodes\": " + nodes + "}"); });
  }
  Error linksError(const std::string& links) {
    return errorOf([&] {
      build(R"({"weir": 1, "nodes": {"a": {"type": "Source"}, "r": {"type": "Relay"}, "s": {"type": "Sum"},
             "t": {"type": "NeedsFile", "params": {"file": "x"}}},
"links": )" +
            links + "}");
    });
  }

  Registry registry;
  std::vector<std::string> warnings;
};

TEST_F(SceneTest, BuildsAllThatTheFileSays) {
  const auto scene = build(test::kTestScene);
  EXPECT_EQ(scene->title, "Zahlen – 数");
  EXPECT_EQ(scene->file, "s.json");
  EXPECT_EQ(scene->schema, "weir.schema.json");
  EXPECT_EQ(scene->world.gravity.get(), (Vec3f{0, -1, 0}));
  EXPECT_EQ(scene->world.dt, 0.01);
  EXPECT_EQ(scene->world.frameRate, 30);
  EXPECT_EQ(scene->plugins.at(0).resolved, "/scenes/libmine.so");
  EXPECT_EQ(scene->graph.nodes().size(), 6u);
  EXPECT_EQ(scene->graph.links().size(), 5u);

  const auto& a = dynamic_cast<const test::Source&>(*scene->graph.find("a"));
  EXPECT_TRUE(a.flag);
  EXPECT_EQ(a.count, 7);
  EXPECT_EQ(a.big, 9007199254740993);
  EXPECT_EQ(a.speed, 0.1f);
  EXPECT_EQ(a.size.get(), (Vec2f{3, 4}));
  EXPECT_EQ(a.color.get(), (Color{1, 128 / 255.0f, 0, 1}));
  EXPECT_EQ(a.rotation->degrees, (Vec3f{0, 90, 0}));
  EXPECT_EQ(a.label.get(), "Tür \"1\"");
  EXPECT_EQ(a.file->text, "data/a.txt");
  EXPECT_EQ(a.file->resolved, "/scenes/data/a.txt");
  EXPECT_EQ(a.files->at(0).resolved, "/scenes/x.obj");
  EXPECT_EQ(a.files->at(1).resolved, "/y.obj");
  EXPECT_EQ(a.profile->points.size(), 3u);
  EXPECT_EQ(a.shape, TestShape::kSphere);
  EXPECT_EQ(a.limit.get(), 4.5);
  EXPECT_EQ(a.points->at(1), (Vec3f{4, 5, 6}));
  EXPECT_EQ(a.start->time, 2);
  EXPECT_EQ(a.path.size(), 2u);

  auto& worker = dynamic_cast<test::Worker&>(*scene->graph.find("worker"));
  EXPECT_EQ(worker.pipeline()->names(), (std::vector<std::string>{"more", "scale", "add", "extra"}));
  EXPECT_EQ(worker.result(10), 10 * 0.5 * 2 + 1 + 1);

  const auto& stage = dynamic_cast<const test::Stage&>(*scene->sections.at("stage"));
  EXPECT_EQ(stage.width, 640);
  EXPECT_EQ(stage.keyframes[1].time, 2);
}

TEST_F(SceneTest, ABundledSectionWithoutItsPluginIsKeptWithAWarning) {
  const auto scene = build(test::kTestScene);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0], "s.json:24:13: /render");
  EXPECT_CONTAINS(warnings[0], "ignored");
  EXPECT_EQ(scene->unknownSections.at("render").find("camera")->find("eye")->asArray().size(), 3u);
}

TEST_F(SceneTest, ASectionIsThereWithDefaultsIfTheFileHasNone) {
  const auto scene = build(R"({"weir": 1, "nodes": {"a": {"type": "Source"}}})");
  EXPECT_EQ(dynamic_cast<const test::Stage&>(*scene->sections.at("stage")).width, 1280);
  EXPECT_TRUE(warnings.empty());
}

TEST_F(SceneTest, WritingBackGivesTheSameScene) {
  const Value once = sceneToValue(*build(test::kTestScene));
  const Value twice = sceneToValue(*build(writeJson(once)));
  EXPECT_EQ(once, twice);
  EXPECT_EQ(writeJson(once), writeJson(twice));
  const auto scene = build(writeJson(once));
  auto& worker = dynamic_cast<test::Worker&>(*scene->graph.find("worker"));
  EXPECT_EQ(worker.pipeline()->names(), (std::vector<std::string>{"more", "scale", "add", "extra"}));
  EXPECT_EQ(worker.result(10), 12);
}

TEST_F(SceneTest, OnlyWhatDiffersFromTheDefaultsIsWritten) {
  const auto scene = build(R"({"weir": 1, "title": "", "world": {"dt": 0.001, "duration": 1},
    "nodes": {"a": {"type": "Source", "params": {"speed": 1.5, "count": 4, "profile": [[0,0],[1,1]]}},
              "w": {"type": "Worker", "modules": {"scale": {"params": {"factor": 5}}, "add": {"enabled": true}}}},
    "links": ["a.number->w.in"], "stage": {}})");
  EXPECT_EQ(sceneToValue(*scene), parseJson(R"({"weir": 1, "world": {"duration": 1},
    "nodes": {"a": {"type": "Source", "params": {"count": 4, "profile": [[0,0],[1,1]]}}, "w": {"type": "Worker"}},
    "links": ["a.number -> w.in"]})",
                                            "expected"));
}

TEST_F(SceneTest, TheVersionComesFirst) {
  const auto error = [&](const std::string& text) { return errorOf([&] { build(text); }); };
  EXPECT_CONTAINS(error("[]").what(), "s.json:1:1: found [] as the whole scene");
  EXPECT_CONTAINS(error("{}").what(), "does not say its version");
  EXPECT_CONTAINS(error("{\"weir\": \"1\"}").what(), "s.json:1:10: /weir: found \"1\"");
  EXPECT_CONTAINS(error("{\"weir\": 0}").what(), "found 0");
  const Error newer = error("{\"weir\": 2, \"unheardOf\": 1}");
  EXPECT_CONTAINS(newer.message(), "version 2, which is newer");
  EXPECT_CONTAINS(newer.allowed(), "versions up to 1");
}

TEST_F(SceneTest, UnknownKeysAreErrorsWithASuggestion) {
  Error e = errorOf([&] { build(R"({"weir": 1, "node": {}})"); });
  EXPECT_CONTAINS(e.what(), "s.json:1:21: /node: a scene has no member 'node'");
  EXPECT_CONTAINS(e.hint(), "'nodes'");
  e = errorOf([&] { build(R"({"weir": 1, "world": {"gravitiy": 1}})"); });
  EXPECT_CONTAINS(e.what(), "/world/gravitiy: there is no parameter 'gravitiy'");
  EXPECT_CONTAINS(e.hint(), "'gravity'");
  e = errorOf([&] { build(R"({"weir": 1, "stages": {}})"); });
  EXPECT_CONTAINS(e.hint(), "'stage'");
  e = errorOf([&] { build(R"({"weir": 1, "stage": {"camera": {"positon": [0,0,0]}}})"); });
  EXPECT_CONTAINS(e.what(), "/stage/camera/positon");
  EXPECT_CONTAINS(e.hint(), "'position'");
  e = nodesError(R"({"a": {"type": "Source", "comment": "x"}})");
  EXPECT_CONTAINS(e.what(), "s.json:2:46: /nodes/a/comment: node 'a': a node has no member 'comment'");
  e = nodesError(R"({"a": {"type": "Source", "params": {"sped": 1}}})");
  EXPECT_CONTAINS(e.what(), "s.json:2:54: /nodes/a/params/sped: node 'a': there is no parameter 'sped'");
  EXPECT_CONTAINS(e.hint(), "'speed'");
}

TEST_F(SceneTest, ASceneNeedsANode) {
  EXPECT_CONTAINS(errorOf([&] { build(R"({"weir": 1})"); }).what(), "no \"nodes\"");
  EXPECT_CONTAINS(nodesError("{}").what(), "s.json:2:10: /nodes: the scene has no nodes");
  EXPECT_CONTAINS(nodesError("[]").what(), "at least one node");
  EXPECT_CONTAINS(nodesError("null").what(), "found null");
}

TEST_F(SceneTest, NodesAreChecked) {
  EXPECT_CONTAINS(nodesError(R"({"a": 1})").what(), "s.json:2:16: /nodes/a: node 'a': found 1");
  EXPECT_CONTAINS(nodesError(R"({"a": {}})").what(), "the node has no \"type\"");
  EXPECT_CONTAINS(nodesError(R"({"a": {"type": 3}})").what(), "/nodes/a/type: node 'a': found 3");
  const Error type = nodesError(R"({"a": {"type": "Sorce"}})");
  EXPECT_CONTAINS(type.what(), "s.json:2:25: /nodes/a/type: node 'a': there is no node type 'Sorce'");
  EXPECT_CONTAINS(type.hint(), "'Source'");
  EXPECT_CONTAINS(type.allowed(), "Relay");
  for (const char* name : {"", "2a", "a b", "a.b", "world", "render", "title", "stage", "ä"})
    EXPECT_EQ(nodesError("{\"" + std::string(name) + "\": {\"type\": \"Source\"}}").location().line, 2)
        << name;
  EXPECT_CONTAINS(nodesError(R"({"a": {"type": "Source", "params": []}})").what(),
                  "/nodes/a/params: node 'a': found []");
  EXPECT_CONTAINS(nodesError(R"({"a": {"type": "Source", "modules": {}}})").what(), "has no modules");
  EXPECT_CONTAINS(nodesError(R"({"a": {"type": "NeedsFile"}})").what(),
                  "s.json:2:16: /nodes/a/params: node 'a': no file");
}

TEST_F(SceneTest, AParameterErrorSaysEverything) {
  const Error e = nodesError("{\"a\": {\"type\": \"Source\", \"params\": {\n  \"spacing\": -2}}}");
  EXPECT_STREQ(e.what(),
               "s.json:3:14: /nodes/a/params/spacing: node 'a': parameter 'spacing': found -2\n"
               "  allowed: a number above 0 [m]");
}

TEST_F(SceneTest, ModuleErrorsAreLocated) {
  const auto error = [&](const std::string& modules) {
    return nodesError("{\"w\": {\"type\": \"Worker\", \"modules\": " + modules + "}}");
  };
  EXPECT_CONTAINS(error("[]").what(), "/nodes/w/modules: node 'w': found []");
  EXPECT_CONTAINS(error(R"({"scal": {}})").hint(), "'scale'");
  EXPECT_CONTAINS(error(R"({"scale": {"param": {}}})").what(), "/nodes/w/modules/scale/param");
  EXPECT_CONTAINS(error(R"({"scale": {"type": "ScalRule"}})").what(), "/nodes/w/modules/scale/type");
  EXPECT_CONTAINS(error(R"({"scale": {"type": "Stranger"}})").what(), "does not fit here");
  EXPECT_CONTAINS(error(R"({"scale": {"params": {"factor": 0}}})").what(),
                  "/nodes/w/modules/scale/params: node 'w': the factor is 0");
  EXPECT_CONTAINS(
      error(R"({"scale": {"params": {"factor": "x"}}})").what(),
      "s.json:2:78: /nodes/w/modules/scale/params/factor: node 'w': parameter 'factor': found \"x\"");
  EXPECT_CONTAINS(error(R"({"new": {"type": "AddRule"}})").what(), "has no place");
  EXPECT_CONTAINS(error(R"({"new.x": {"type": "AddRule", "after": "add"}})").what(),
                  "not a valid name for a module");
  EXPECT_CONTAINS(error(R"({"add": {"after": "ad"}})").hint(), "'add'");
}

TEST_F(SceneTest, LinksAreChecked) {
  EXPECT_CONTAINS(linksError("{}").what(), "/links: found an object");
  EXPECT_CONTAINS(linksError("[1]").what(), "s.json:3:11: /links/0: found 1");
  for (const char* form :
       {"", "a", "->", "a.number", "a.number ->", "a.number -> r", ". -> .", "a.b.c -> r.in"})
    EXPECT_CONTAINS(linksError("[\"" + std::string(form) + "\"]").allowed(), "node.output -> node.input");
  EXPECT_CONTAINS(linksError(R"(["b.number -> r.in"])").what(),
                  "s.json:3:11: /links/0: there is no node 'b'");
  EXPECT_CONTAINS(linksError(R"(["a.nummer -> r.in"])").hint(), "'number'");
  EXPECT_CONTAINS(linksError(R"(["a.number -> r.inn"])").what(), "'r' (Relay) has no input 'inn'");
  EXPECT_CONTAINS(linksError(R"(["t.text -> r.in"])").what(),
                  "the output is a Text, the input takes a Number");
  EXPECT_CONTAINS(linksError(R"(["r.out -> r.in"])").what(), "closes a cycle: r -> r");
  EXPECT_CONTAINS(linksError(R"(["a.number -> r.in",
      "s.total -> r.in"])")
                      .what(),
                  "s.json:4:7: /links/1: 'r.in' is linked to 'a.number' already, and again to 's.total'");
  EXPECT_CONTAINS(linksError("[]").what(), "/nodes/r: node 'r': the input 'r.in' is not linked");
}

TEST_F(SceneTest, TooManyNodesOrLinksAreRefused) {
  std::string nodes = "{";
  for (std::size_t i = 0; i <= kMaxNodes; ++i)
    nodes += (i > 0 ? ", \"n" : "\"n") + std::to_string(i) + R"(": {"type": "Source"})";
  EXPECT_CONTAINS(nodesError(nodes + "}").what(), "2001 nodes");
  std::string links = "[";
  for (std::size_t i = 0; i <= kMaxLinks; ++i) links += i > 0 ? ", 1" : "1";
  EXPECT_CONTAINS(linksError(links + "]").what(), "10001 links");
}

TEST_F(SceneTest, PluginsAreNamedBeforeTheSceneIsBuilt) {
  const auto plugins = [](std::string_view text) {
    return scenePlugins(parseJson(text, "s.json"), {"s.json", "", "/scenes"});
  };
  EXPECT_TRUE(plugins("{}").empty());
  EXPECT_TRUE(plugins("[]").empty());
  const auto files = plugins(R"({"plugins": ["a.so", "/b.so"]})");
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].resolved, "/scenes/a.so");
  EXPECT_EQ(files[1].resolved, "/b.so");
  EXPECT_CONTAINS(errorOf([&] { plugins(R"({"plugins": "a.so"})"); }).what(),
                  "s.json:1:13: /plugins: found \"a.so\"");
  EXPECT_CONTAINS(errorOf([&] { plugins(R"({"plugins": [""]})"); }).what(), "s.json:1:14: /plugins/0");
}

TEST_F(SceneTest, LoadsAFile) {
  const std::filesystem::path path = testing::TempDir() + "weir_scene_test.json";
  std::ofstream(path) << test::kTestScene;
  const auto scene = loadScene(path, registry, {}, warnings);
  EXPECT_EQ(scene->file, path.string());
  EXPECT_EQ(scene->text, test::kTestScene);
  EXPECT_EQ(dynamic_cast<const test::Source&>(*scene->graph.find("a")).file->resolved,
            path.parent_path() / "data/a.txt");
  std::filesystem::remove(path);
  EXPECT_EQ(errorOf([&] { loadScene(path, registry, {}, warnings); }).kind(), ErrorKind::kIo);
}

}  // namespace
}  // namespace weir
