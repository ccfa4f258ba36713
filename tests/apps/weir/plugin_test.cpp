// Plugins: loaded on demand, checked before anything of them runs, and an error that says what is wrong.
#include "framework/graph/plugin.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "framework/base/sanitizers.h"
#include "framework/run/simulation.h"
#include "framework/scene/scene_file.h"
#include "nodes/particle_fluid/particle_fluid.h"
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
  result = runWeir({"run", naming, "--allow-plugins", "--stats", stats});
  EXPECT_EQ(result.code, 0) << result.err;
  expectLifted(stats);
  EXPECT_CONTAINS(runWeir({"nodes", "Lift", "--plugin", testPlugin("lift")}).out, "Speed upwards.");
  EXPECT_CONTAINS(runWeir({"info", "--plugin", testPlugin("lift")}).out, "Lifts a fluid.");
}

// Code of strangers: a scene is data until its user says otherwise.
TEST(Plugins, ASceneLoadsNoneUnasked) {
  const TemporaryFolder folder;
  std::filesystem::copy(testPlugin("lift"), folder / "lift.so");
  const std::string scene = folder.write("s.json", liftScene("\"lift.so\""));
  for (const char* command : {"run", "validate"}) {
    const ChildResult refused = runWeir({command, scene});
    EXPECT_EQ(refused.code, 3) << command;
    EXPECT_CONTAINS(refused.err, "s.json: /plugins/0: the scene asks for the plugin 'lift.so'");
    EXPECT_CONTAINS(refused.err, "--allow-plugins");
    EXPECT_EQ(runWeir({command, scene, "--allow-plugins"}).code, 0) << command;
    EXPECT_EQ(runWeir({command, scene, "--plugin", folder / "lift.so"}).code, 0) << command;
    ChildOptions trusted;
    trusted.environment["WEIR_PLUGIN_PATH"] = folder.path();
    EXPECT_EQ(runWeir({command, scene}, trusted).code, 0) << command;
  }
  // Nothing of it ran: this one ends the program when it is loaded.
  const std::string exits = folder.write("e.json", liftScene('"' + testPlugin("static_exits") + '"'));
  EXPECT_CONTAINS(runWeir({"validate", exits}).err, "whose code would run");
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
                                         std::pair{"wrong_headers", "0.0.9, headers 0123456789abcdef"},
                                         std::pair{"wrong_build", "another compiler"},
                                         std::pair{"twice", "two libraries add the node type 'Source'"},
                                         std::pair{"throws", "no licence found"},
                                         std::pair{"taken_name", "ParticleFluid"},
                                         std::pair{"no_plugin", "is not a Weir plugin"},
                                         std::pair{"missing_symbol", "nobodyHasThis()"},
                                         std::pair{"static_throws", "no licence found"},
                                         std::pair{"static_crashes", "cannot be made: signal 11"},
                                         std::pair{"static_exits", "with exit code 3"}),
                         [](const auto& tested) { return std::string(tested.param.first); });

TEST(Plugins, WhatCannotBeLoadedFromAFolderIsLeftOut) {
  const TemporaryFolder folder;
  for (const std::string name : {"lift", "static_throws", "static_crashes", "throws"})
    std::filesystem::copy(testPlugin(name), folder / (name + ".so"));
  ChildOptions options;
  options.environment["WEIR_PLUGIN_PATH"] = "/none/such:" + folder.path();
  const ChildResult result = runWeir({"run", folder.write("s.json", liftScene(""))}, options);
  EXPECT_EQ(result.code, 0) << result.err;
  for (const std::string name : {"static_throws", "static_crashes", "throws"})
    EXPECT_CONTAINS(result.err, "going on without a plugin: " + folder.path() + "/" + name + ".so");
}

std::string failingScene(const std::string& nodeHook, const std::string& moduleHook) {
  return R"({ "weir": 1, "world": { "duration": 0.1, "cfl": 0.5 },
    "nodes": {
      "drop": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.1, 0.1, 0.1] } },
      "culprit": { "type": "FailingNode", "params": { "hook": ")" +
         nodeHook + R"(" } },
      "water": { "type": "ParticleFluid", "params": { "spacing": 0.1 },
                 "modules": { "wrong": { "type": "FailingModule", "after": "boundary",
                                         "params": { "hook": ")" +
         moduleHook + R"(" } } } } },
    "links": [ "drop.particles -> water.initial" ] })";
}

struct FailingHook {
  const char *name, *node, *module, *where, *hook, *what;
};

class FailingPlugin : public testing::TestWithParam<FailingHook> {};

TEST_P(FailingPlugin, IsNamedAndTheHostEndsInOrder) {
  const FailingHook& hook = GetParam();
  const TemporaryFolder folder;
  const std::string scene = folder.write("s.json", failingScene(hook.node, hook.module));
  const ChildResult result =
      runWeir({"run", scene, "--plugin", testPlugin("failing_hooks"), "--stats", folder / "stats.json",
               "--checkpoint", folder / "state.h5", "--checkpoint-every", "2"});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.err, hook.where);
  EXPECT_CONTAINS(result.err, std::string(hook.hook) + " (plugin failing_hooks): ");
  EXPECT_CONTAINS(result.err, hook.what);
  // Observers were told, too.
  EXPECT_CONTAINS(readFile(folder / "stats.json"), "failed");
}

INSTANTIATE_TEST_SUITE_P(
    All, FailingPlugin,
    testing::Values(
        FailingHook{"NodeConfigure", "configure", "", "node 'culprit'", "configure", "mistake in configure"},
        FailingHook{"NodeEstimate", "estimate", "", "node 'culprit'", "estimate", "mistake in estimate"},
        FailingHook{"NodeReset", "reset", "", "node 'culprit'", "reset", "mistake in reset"},
        FailingHook{"NodeLongestStep", "longestStep", "", "node 'culprit'", "longestStep",
                    "mistake in longestStep"},
        FailingHook{"NodeStep", "step", "", "node 'culprit'", "step", "mistake in step"},
        FailingHook{"NodeFrame", "frame", "", "node 'culprit'", "frame", "mistake in frame"},
        FailingHook{"NodeError", "step_error", "", "node 'culprit'", "step", "mistake in step_error"},
        FailingHook{"NodeCheck", "step_check", "", "node 'culprit'", "step", "1 == 2"},
        FailingHook{"NodeOther", "step_no_exception", "", "node 'culprit'", "step", "says nothing"},
        FailingHook{"NodeSave", "save", "", "node 'culprit'", "save", "mistake in save"},
        FailingHook{"ModuleMemory", "", "memory", "node 'water'", "module 'wrong', memory",
                    "mistake in memory"},
        FailingHook{"ModuleReset", "", "reset", "node 'water'", "module 'wrong', reset", "mistake in reset"},
        FailingHook{"ModuleWarn", "", "warn", "node 'water'", "module 'wrong', warn", "mistake in warn"},
        FailingHook{"ModuleStep", "", "step", "node 'water'", "module 'wrong', step", "mistake in step"},
        FailingHook{"ModuleSave", "", "save", "node 'water'", "module 'wrong', save", "mistake in save"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Plugins, WhatFailsWhenAStateIsTakenBackIsNamed) {
  for (const auto& [node, module, where] :
       {std::tuple{"restore", "", "node 'culprit': restore (plugin failing_hooks): "},
        std::tuple{"", "restore", "module 'wrong', restore (plugin failing_hooks): "}}) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("s.json", failingScene(node, module));
    const std::string state = folder / "state.h5", plugin = testPlugin("failing_hooks");
    ChildResult result =
        runWeir({"run", scene, "--plugin", plugin, "--checkpoint", state, "--checkpoint-every", "2"});
    ASSERT_EQ(result.code, 0) << result.err;
    result = runWeir({"run", scene, "--plugin", plugin, "--resume", state});
    EXPECT_EQ(result.code, 4) << result.err;
    EXPECT_CONTAINS(result.err, where);
    EXPECT_CONTAINS(result.err, "mistake in restore");
  }
}

TEST(Plugins, ParametersThatAPluginRefusesByAnExceptionNameIt) {
  const TemporaryFolder folder;
  const std::string plugin = testPlugin("failing_hooks");
  ChildResult result =
      runWeir({"validate", folder.write("n.json", failingScene("validate", "")), "--plugin", plugin});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.err, "node 'culprit': validate (plugin failing_hooks): ");
  result = runWeir({"validate", folder.write("m.json", failingScene("", "validate")), "--plugin", plugin});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.err, "module 'wrong', validate (plugin failing_hooks): ");
  std::string section = failingScene("", "");
  section.insert(section.find("\"world\""), "\"failing\": { \"fails\": true }, ");
  result = runWeir({"validate", folder.write("s.json", section), "--plugin", plugin});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.err, "section 'failing', validate (plugin failing_hooks): ");
}

TEST(Plugins, AReportThatFailsStandsInTheStatistics) {
  const TemporaryFolder folder;
  const std::string stats = folder / "stats.json";
  const ChildResult result = runWeir({"run", folder.write("s.json", failingScene("report", "report")),
                                      "--plugin", testPlugin("failing_hooks"), "--stats", stats});
  EXPECT_EQ(result.code, 0) << result.err;
  const Value v = parseJson(readFile(stats), stats);
  EXPECT_CONTAINS(v.find("nodes")->find("culprit")->find("error")->asString(),
                  "report (plugin failing_hooks): ");
  EXPECT_CONTAINS(v.find("nodes")->find("water")->find("error")->asString(),
                  "module 'wrong', report (plugin failing_hooks): ");
}

class FailingOutput : public testing::TestWithParam<const char*> {};

TEST_P(FailingOutput, IsNamedAndTheHostEndsInOrder) {
  const std::string hook = GetParam();
  const TemporaryFolder folder;
  const std::string scene = folder.write("s.json", failingScene("", ""));
  const std::string state = folder / "state.h5";
  std::vector<std::string> arguments{"run",
                                     scene,
                                     "--plugin",
                                     testPlugin("failing_hooks"),
                                     "--failing",
                                     folder / hook,
                                     "--checkpoint",
                                     state,
                                     "--checkpoint-every",
                                     "2",
                                     "--stats",
                                     folder / "stats.json"};
  ChildResult result = runWeir(arguments);
  if (hook == "resume") {
    ASSERT_EQ(result.code, 0) << result.err;
    arguments.insert(arguments.end(), {"--resume", state});
    result = runWeir(arguments);
  }
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.err, "output 'failing', " + hook + " (plugin failing_hooks): ");
  EXPECT_CONTAINS(result.err, "mistake in " + hook);
}

INSTANTIATE_TEST_SUITE_P(All, FailingOutput,
                         testing::Values("create", "name", "begin", "save", "resume", "capture", "write",
                                         "end"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(Plugins, CheckpointsThatFailNameTheirPlugin) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("s.json", failingScene("", ""));
  const std::string plugin = testPlugin("failing_hooks"), stats = folder / "stats.json";
  ChildResult result = runWeir({"run", scene, "--plugin", plugin, "--stats", stats, "--checkpoint",
                                folder / "write.failing", "--checkpoint-every", "2"});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.err, "checkpoints 'failing', write (plugin failing_hooks): ");
  EXPECT_CONTAINS(result.err, "mistake in write");
  EXPECT_CONTAINS(readFile(stats), "failed");
  result = runWeir(
      {"run", scene, "--plugin", plugin, "--checkpoint", folder / "read.failing", "--checkpoint-every", "2"});
  ASSERT_EQ(result.code, 0) << result.err;
  result = runWeir({"run", scene, "--plugin", plugin, "--resume", folder / "read.failing"});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.err, "checkpoints 'failing', read (plugin failing_hooks): ");
}

TEST(Plugins, RecordingsThatFailNameTheirPlugin) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("s.json", failingScene("", ""));
  for (const auto& [file, hook] :
       {std::pair{"open", "open"}, std::pair{"nothing", "open"}, std::pair{"times", "times"},
        std::pair{"fluids", "fluids"}, std::pair{"read", "read"}}) {
    const ChildResult result =
        runWeir({"render", folder.write(std::string(file) + ".failing", ""), "--scene", scene, "--plugin",
                 testPlugin("failing_hooks"), "--images", folder / file});
    EXPECT_EQ(result.code, 4) << result.err;
    EXPECT_CONTAINS(result.err,
                    std::string("recording reader 'failing', ") + hook + " (plugin failing_hooks): ");
  }
}

TEST(Plugins, ATypeThatCannotBeMadeNamesItsPlugin) {
  const TemporaryFolder folder;
  const std::string scene =
      folder.write("s.json", R"({ "weir": 1, "nodes": { "a": { "type": "FailsAtBirth" } } })");
  for (const std::string command : {"run", "validate"}) {
    const ChildResult result = runWeir({command, scene, "--plugin", testPlugin("failing_hooks")});
    EXPECT_EQ(result.code, 4) << result.err;
    EXPECT_CONTAINS(result.err, "node type 'FailsAtBirth' (plugin failing_hooks)");
    EXPECT_CONTAINS(result.err, "mistake in the constructor");
  }
}

#ifdef WEIR_ADDRESS_SANITIZER
TEST(Plugins, TheSanitizerSeesWhatAPluginWritesBehindItsArrays) {
  const TemporaryFolder folder;
  std::string text = liftScene("");
  text.replace(text.find("Lift"), 4, "OutOfBounds").erase(text.find(", \"params\": { \"speed\": 3 }"), 26);
  const ChildResult result =
      runWeir({"run", folder.write("s.json", text), "--plugin", testPlugin("out_of_bounds")});
  EXPECT_NE(result.code, 0);
  EXPECT_CONTAINS(result.err, "AddressSanitizer");
  EXPECT_CONTAINS(result.err, "out_of_bounds");
}
#endif

/// Particles that fall into a drain while others are born, so that they are sorted, removed and added.
constexpr const char* kTagged = R"({
  "weir": 1, "world": { "dt": 0.005, "duration": 0.3, "frame_rate": 10 },
  "nodes": {
    "nozzle": { "type": "SquareEmitter", "params": { "position": [0, 1, 0], "width": 0.3, "height": 0.3, "speed": 4 } },
    "block": { "type": "BoxSampler", "params": { "min": [-0.3, 0, -0.3], "max": [0.3, 0.5, 0.3] } },
    "water": { "type": "ParticleFluid",
               "params": { "spacing": 0.1, "domain_min": [-1, -0.1, -1], "domain_max": [1, 2, 1] },
               "modules": { "viscosity": { "params": { "rate": 60 } }, "tag": { "type": "Tagger", "after": "boundary" } } } },
  "links": [ "block.particles -> water.initial", "nozzle.particles -> water.emitters" ]
})";

TEST(Plugins, AttributesOfAModuleTravelWithTheirParticles) {
  Registry registry;
  registerNodes(registry);
  const Plugin plugin(testPlugin("tagger"), registry);
  std::vector<std::string> warnings;
  auto scene = buildScene(parseJson(kTagged, "s"), {"s", "", "."}, registry, {}, warnings);
  const auto device = openDevice("cpu", 2);
  Log log;
  Simulation simulation(std::move(scene), *device, log, registry);
  simulation.reset();
  auto& water = dynamic_cast<ParticleFluid&>(*simulation.scene().graph.find("water"));
  constexpr std::int64_t kFirst = 180;  // particles of the block
  const std::atomic<bool> never = false;
  while (simulation.advanceFrame(never)) {
  }
  const ParticleSet& particles = water.fluid->set();
  const std::int64_t n = particles.bound();
  const std::vector<std::int64_t> ids = particles.ids().toHost(n);
  const std::vector<float> tags = particles.get<float>("tag").toHost(n);
  const std::vector<Vec3f> vectors = particles.get<Vec3f>("tag_vector").toHost(n);
  const std::vector<Mat3f> matrices = particles.get<Mat3f>("tag_matrix").toHost(n);
  const std::vector<int> numbers = particles.get<int>("tag_number").toHost(n);
  bool sorted = false;
  std::int64_t born = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto id = static_cast<float>(ids[i]);
    EXPECT_EQ(tags[i], 3 * id + 1);
    EXPECT_EQ(vectors[i], (Vec3f{id, 2 * id, -id}));
    EXPECT_EQ(matrices[i], (Mat3f{{{}, vectors[i], {}}}));
    EXPECT_EQ(numbers[i], ids[i] + 7);
    sorted |= i > 0 && ids[i] < ids[i - 1];
    born += ids[i] >= kFirst ? 1 : 0;
  }
  EXPECT_TRUE(sorted);
  EXPECT_GT(born, 10);
  EXPECT_GT(n - born, 10);           // of the block, some are left
  EXPECT_LT(n - born, kFirst - 10);  // and some were removed
}

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
