// Plugins: loaded on demand, checked before anything of them runs, and an error that says what is wrong.
#include "framework/graph/plugin.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "framework/scene/scene_file.h"
#include "nodes/register_nodes.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

std::string testPlugin(const std::string& name) {
  return buildFolder() + "/lib/weir/test_plugins/" + name + ".so";
}

constexpr const char* kLifted = R"({
  "weir": 1, "plugins": [PLUGIN],
  "world": { "duration": 0.1, "gravity": [0, 0, 0] },
  "nodes": {
    "drop": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.1, 0.1, 0.1] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.1 },
               "modules": { "lift": { "type": "Lift", "after": "boundary", "params": { "speed": 3 } } } } },
  "links": [ "drop.particles -> water.initial" ]
})";

std::string liftScene(const std::string& pluginList) {
  std::string text = kLifted;
  return text.replace(text.find("PLUGIN"), std::string("PLUGIN").size(), pluginList);
}

void expectLifted(const std::string& stats) {
  const Value v = parseJson(readFile(stats), stats);
  EXPECT_NEAR(v.find("nodes")->find("water")->find("max_speed")->asDouble(), 3, 1e-6);
}

TEST(Plugins, AModuleOfAPluginRunsInAScene) {
  const TemporaryFolder folder;
  const std::string stats = folder / "stats.json";
  const std::string plain = folder.write("plain.json", liftScene(""));
  const std::string naming = folder.write("naming.json", liftScene('"' + testPlugin("lift") + '"'));

  EXPECT_EQ(runWeir({"run", plain}).code, 3);
  ChildResult result = runWeir({"run", plain, "--plugin", testPlugin("lift"), "--stats", stats});
  EXPECT_EQ(result.code, 0) << result.err;
  expectLifted(stats);
  result = runWeir({"run", naming, "--stats", stats});
  EXPECT_EQ(result.code, 0) << result.err;
  expectLifted(stats);
  EXPECT_CONTAINS(runWeir({"nodes", "Lift", "--plugin", testPlugin("lift")}).out, "Speed upwards.");
  EXPECT_CONTAINS(runWeir({"info", "--plugin", testPlugin("lift")}).out, "Lifts a fluid.");
}

TEST(Plugins, ThoseOfAFolderAreFound) {
  const TemporaryFolder folder;
  std::filesystem::copy(testPlugin("lift"), folder / "lift.so");
  std::filesystem::copy(testPlugin("wrong_version"), folder / "wrong_version.so");
  ChildOptions options;
  options.environment["WEIR_PLUGIN_PATH"] = folder.path();
  const ChildResult result = runWeir({"run", folder.write("s.json", liftScene(""))}, options);
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_CONTAINS(result.err, "wrong_version.so");
}

class BrokenPlugin : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(BrokenPlugin, IsRefusedAndNamed) {
  const auto& [name, message] = GetParam();
  const ChildResult result = runWeir({"nodes", "--plugin", testPlugin(name)});
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_CONTAINS(result.err, std::string(name) + ".so");
  EXPECT_CONTAINS(result.err, message);
}

INSTANTIATE_TEST_SUITE_P(All, BrokenPlugin,
                         testing::Values(std::pair{"wrong_version", "version 999 of the interface"},
                                         std::pair{"wrong_build", "another compiler"},
                                         std::pair{"throws", "no licence found"},
                                         std::pair{"taken_name", "ParticleFluid"},
                                         std::pair{"no_plugin", "is no Weir plugin"},
                                         std::pair{"missing_symbol", "nobodyHasThis"}),
                         [](const auto& tested) { return std::string(tested.param.first); });

TEST(Plugins, AFailedRegistrationLeavesTheRegistryAsItWas) {
  Registry registry;
  registerNodes(registry);
  const std::size_t before = registry.nodes().size();
  errorOf([&] { Plugin(testPlugin("throws"), registry); });
  EXPECT_EQ(registry.nodes().size(), before);
  EXPECT_EQ(registry.source(), "weir");
}

TEST(Plugins, TextIsNoPlugin) {
  const TemporaryFolder folder;
  const ChildResult result = runWeir({"nodes", "--plugin", folder.write("text.so", "hello")});
  EXPECT_EQ(result.code, 5);
  EXPECT_CONTAINS(result.err, "text.so");
}

}  // namespace
}  // namespace weir::test
