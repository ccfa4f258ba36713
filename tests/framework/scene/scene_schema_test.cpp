#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "framework/scene/expand.h"
#include "framework/scene/scene_file.h"
#include "tests/support/scene_mutator.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

class SceneSchema : public testing::Test {
 protected:
  SceneSchema() {
    test::registerTestTypes(registry);
    schema = sceneSchema(registry);
  }
  /// The part of the schema at a path of members.
  const Value& at(std::initializer_list<const char*> path) {
    const Value* v = &schema;
    for (const char* key : path) {
      v = v->find(key);
      if (v == nullptr) {
        ADD_FAILURE() << "no member " << key;
        return schema;
      }
    }
    return *v;
  }

  Registry registry;
  Value schema;
};

TEST_F(SceneSchema, SaysWhichDraftItIs) {
  EXPECT_EQ(at({"$schema"}), Value("https://json-schema.org/draft/2020-12/schema"));
  EXPECT_EQ(at({"additionalProperties"}), Value(false));
  // Both may come from an included file.
  EXPECT_EQ(at({"anyOf"}).asArray()[0], Value(Value::Object{{"required", Value::Array{"weir", "nodes"}}}));
  EXPECT_EQ(at({"anyOf"}).asArray()[1], Value(Value::Object{{"required", Value::Array{"$include"}}}));
  EXPECT_EQ(at({"properties", "weir", "const"}), Value(1));
}

TEST_F(SceneSchema, DescribesEveryNodeType) {
  for (const auto& [name, type] : registry.nodes()) {
    const std::string definition = "node." + name;
    const Value& node = at({"$defs", definition.c_str()});
    EXPECT_EQ(*node.find("description"), Value(type.info.doc));
    EXPECT_EQ(*node.find("additionalProperties"), Value(false));
    EXPECT_EQ(*node.find("properties")->find("params"), withShorthand(type.create()->schema()));
  }
  EXPECT_EQ(at({"$defs", "node", "allOf"}).asArray().size(), registry.nodes().size());
}

TEST_F(SceneSchema, DescribesSectionsAndWorld) {
  EXPECT_EQ(at({"properties", "stage", "description"}), Value("How the scene is shown."));
  EXPECT_EQ(at({"properties", "stage", "properties", "width", "maximum"}), Value(8192));
  EXPECT_EQ(at({"properties", "world", "properties", "dt", "exclusiveMinimum"}), Value(0));
  EXPECT_EQ(at({"properties", "world", "properties", "gravity", "description"}),
            Value("Acceleration of gravity. [m/s^2]"));
}

TEST_F(SceneSchema, DescribesModulesByFamily) {
  const Value& family = at({"$defs", "family.Rule", "properties", "type", "enum"});
  EXPECT_EQ(family, Value(Value::Array{"AddRule", "ScaleRule"}));
  EXPECT_NE(at({"$defs", "node.Worker", "properties", "modules", "properties"}).find("scale"), nullptr);
  EXPECT_EQ(at({"$defs", "params.AddRule", "properties", "amount", "maximum"}), Value(10));
  EXPECT_EQ(at({"$defs", "node.Source", "properties"}).find("modules"), nullptr);
}

TEST_F(SceneSchema, ReferencesLeadSomewhere) {
  const std::string text = writeJson(schema);
  const std::string prefix = "\"$ref\": \"#/$defs/";
  std::size_t references = 0;
  for (std::size_t i = text.find(prefix); i != std::string::npos;
       i = text.find(prefix, i + 1), ++references) {
    const std::size_t start = i + prefix.size();
    EXPECT_NE(schema.find("$defs")->find(text.substr(start, text.find('"', start) - start)), nullptr);
  }
  EXPECT_GT(references, registry.nodes().size());
}

/// What a validator must accept beside plain scenes; the test below hands it to one.
constexpr const char* kShorthandScene =
    R"({"$schema": "s", "weir": 1, "note": "n", "let": {"note": "n", "s": 0.1, "n": "=3"},
  "world": {"duration": "2 s", "note": "n", "gravity": [0, "=-s", "1 cm/s^2"]},
  "nodes": {"note": "n", "s_{i}": {"repeat": "=n", "as": "i", "note": "n", "node": {"type": "Source", "note": "n",
      "params": {"count": "=i+1", "spacing": "=s", "note": "n", "start": {"time": "1 s", "note": "n"},
                 "profile": [{"repeat": 3, "item": ["=i", 0]}],
                 "path": [{"repeat": 2, "as": "k", "item": {"time": "=k"}}, {"time": 5}]}}},
    "w": {"type": "Worker", "modules": {"note": "n", "scale": {"note": "n", "params": {"factor": "=2^2"}}}},
    "sum": {"type": "Sum"}},
  "links": ["s_0.number -> w.in", {"repeat": "=n", "item": "s_{i}.number -> sum.terms"}]})";

TEST_F(SceneSchema, TheSceneWithAllShorthandBuilds) {
  std::vector<std::string> warnings;
  const auto scene =
      buildScene(parseJson(kShorthandScene, "s.json"), {"s.json", "", ""}, registry, {}, warnings);
  EXPECT_EQ(scene->graph.nodes().size(), 5u);
}

#ifdef WEIR_TEST_PYTHON
/// An independent validator accepts every scene that buildScene accepts. (Not the other way round: links,
/// cycles and validate() are beyond a schema.)
TEST_F(SceneSchema, AValidatorAcceptsWhatBuilds) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "weir_schema_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "schema.json") << writeJson(schema);
  const test::SceneMutator mutator({std::string(test::kTestScene)});
  int good = 0, bad = 0;
  std::ofstream(folder / ("good" + std::to_string(good++) + ".json")) << kShorthandScene;
  std::ofstream(folder / ("good" + std::to_string(good++) + ".json"))
      << R"({"$include": "base.json", "let": {}})";
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    const std::string text = seed == 0 ? std::string(test::kTestScene) : mutator.mutate(seed);
    std::vector<std::string> warnings;
    try {
      buildScene(parseJson(text, "s.json"), {"s.json", "", ""}, registry, {}, warnings);
      std::ofstream(folder / ("good" + std::to_string(good++) + ".json")) << text;
    } catch (const Error& e) {
      // What a schema can see: a parameter of the wrong kind or out of its range.
      if (!e.location().parameter.empty() && bad < 100)
        std::ofstream(folder / ("bad" + std::to_string(bad++) + ".json")) << text;
    }
  }
  EXPECT_GT(good, 100);
  EXPECT_EQ(bad, 100);
  const std::string command = std::string(WEIR_TEST_PYTHON) + " \"" + WEIR_SOURCE_FOLDER +
                              "/tests/framework/scene/check_schema.py\" \"" + folder.string() + "\"";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::filesystem::remove_all(folder);
}
#endif

}  // namespace
}  // namespace weir
