// The program as a user runs it: files and options in; exit codes, messages and files out.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace weir::test {
namespace {

constexpr std::string_view kDamBreak = R"({
  "weir": 1,
  "title": "A small dam break",
  "world": { "dt": 0.002, "duration": 0.1, "frame_rate": 50 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, 0.2, 0.2] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [0.5, 0.5, 0.2], "inverted": true } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.02 } }
  },
  "links": [ "block.particles -> water.initial", "tank.boundary -> water.boundaries" ]
})";

/// The member that a path of keys leads to.
const Value& member(const Value& value, std::initializer_list<const char*> keys) {
  const Value* at = &value;
  for (const char* key : keys) {
    at = at->find(key);
    if (at == nullptr) throw std::runtime_error(std::string("no member ") + key + " in " + writeJson(value));
  }
  return *at;
}

class Cli : public testing::Test {
 protected:
  std::string scene(std::string_view text = kDamBreak) const {
    return folder.write("scene.json", std::string(text));
  }
  /// The scene with one part of its text exchanged.
  std::string sceneWith(const std::string& part, const std::string& other) const {
    std::string text(kDamBreak);
    const auto at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    return scene(text.replace(at, part.size(), other));
  }
  static void expectFailure(const ChildResult& result, int code, std::initializer_list<const char*> parts) {
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_EQ(result.out, "");
    for (const char* part : parts) EXPECT_CONTAINS(result.err, part);
  }

  TemporaryFolder folder;
};

TEST_F(Cli, AProcessOfALaunchThatNothingJoinsIsRefused) {
  // Without its plugins.
  std::filesystem::create_directories(folder.path() + "/bin");
  const std::string alone = folder.path() + "/bin/weir";
  std::filesystem::copy_file(weirProgram(), alone);
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    ChildOptions options;
    options.environment["LD_LIBRARY_PATH"] = buildFolder() + "/lib:" + buildFolder() + "/lib/weir/bundled";
    options.environment[variable] = "2";
    expectFailure(runChild(alone, {"run", scene()}, options), 2, {"no plugin for MPI", "--ranks N"});
    options.environment[variable] = "1";
    EXPECT_EQ(runChild(alone, {"run", scene(), "--frames", "0"}, options).code, 0);
  }
}

TEST_F(Cli, HelpIsACommandToo) {
  for (const std::vector<std::string>& command : {std::vector<std::string>{}, {"run"}, {"nodes"}}) {
    std::vector<std::string> option = command, asCommand = {"help"};
    option.push_back("--help");
    asCommand.insert(asCommand.end(), command.begin(), command.end());
    const ChildResult expected = runWeir(option), found = runWeir(asCommand);
    EXPECT_EQ(found.code, 0) << found.err;
    EXPECT_EQ(found.out, expected.out);
    EXPECT_CONTAINS(found.out, "--help");
  }
  expectFailure(runWeir({"help", "rum"}), 2, {"there is no command 'rum'", "run"});
  expectFailure(runWeir({"help", "run", "render"}), 2, {"'weir help' takes one command"});
}

TEST_F(Cli, RunsASceneAndWritesStatistics) {
  const std::string stats = folder / "stats.json";
  const ChildResult result = runWeir({"run", scene(), "--stats", stats, "--threads", "2", "--device", "cpu"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out, stats + "\n");
  const Value v = parseJson(readFile(stats), "stats");
  EXPECT_EQ(member(v, {"particles"}).asInt(), 1000);
  EXPECT_EQ(member(v, {"frames"}).asInt(), 5);
  EXPECT_EQ(member(v, {"steps"}).asInt(), 50);
  EXPECT_EQ(member(v, {"end"}).asString(), "finished");
  EXPECT_EQ(member(v, {"device", "back_end"}).asString(), "cpu");
  EXPECT_GT(member(v, {"step_ms", "median"}).asDouble(), 0);
  EXPECT_GT(member(v, {"modules_ms", "water/solver", "per_step"}).asDouble(), 0);
  EXPECT_GT(member(v, {"memory", "host_peak_bytes"}).asInt(), 0);
  // Position, velocity and density of 1000 particles at the least, and no more than all together.
  const std::int64_t ofWater = member(v, {"memory", "device_bytes_of_nodes", "water"}).asInt();
  EXPECT_GT(ofWater, 1000 * 28);
  EXPECT_LE(ofWater, member(v, {"memory", "device_peak_bytes"}).asInt());
  const Value& water = member(v, {"nodes", "water"});
  for (const char* key : {"neighbors", "compression", "solver_iterations", "linear_momentum",
                          "kinetic_energy", "potential_energy", "fluid_volume"})
    EXPECT_NE(water.find(key), nullptr) << key << " is missing in " << writeJson(water);
}

TEST_F(Cli, RefusesPeriodicDomainsThatCannotBe) {
  const auto run = [&](const std::string& params, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"run", sceneWith("\"spacing\": 0.02", "\"spacing\": 0.02, " + params)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runWeir(arguments);
  };
  const std::string box = "\"domain_min\": [0, 0, 0], \"domain_max\": [0.5, 0.5, 0.2]";
  expectFailure(run("\"periodic\": \"z\""), 3, {"domain_min and domain_max", "periodic"});
  expectFailure(run("\"periodic\": \"w\", " + box), 3, {"\"w\"", "xyz"});
  expectFailure(run("\"periodic\": \"z\", \"domain_min\": [0, 0, 0], \"domain_max\": [0.5, 0.5, 0.05]"), 3,
                {"0.05 m long along z", "at least 0.08 m"});
  expectFailure(run("\"periodic\": \"z\", " + box), 3, {"solid of 'tank'", "along z", "both faces"});
  const std::string open = "tank.min=[0, 0, -1]", ends = "tank.max=[0.5, 0.5, 1]";
  const std::string wide = "\"domain_min\": [0, 0, 0.1], \"domain_max\": [0.5, 0.5, 0.3]";
  expectFailure(run("\"periodic\": \"z\", " + wide, {"--set", open, "--set", ends}), 3,
                {"'block'", "outside of the periodic domain"});
  expectFailure(run("\"periodic\": \"z\", " + box, {"--set", open, "--set", ends, "--ranks", "2"}), 3,
                {"periodic domain", "ranks"});
  const ChildResult runs = run("\"periodic\": \"z\", " + box, {"--set", open, "--set", ends, "--quiet"});
  EXPECT_EQ(runs.code, 0) << runs.err;
}

TEST_F(Cli, WritesASeriesOfFrames) {
  const std::string series = folder / "series.jsonl";
  ASSERT_EQ(runWeir({"run", scene(), "--series", series, "--set", "water.spacing=0.05"}).code, 0);
  const std::string text = readFile(series);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6);
  const Value last = parseJson(text.substr(text.rfind('\n', text.size() - 2)), "series");
  EXPECT_EQ(member(last, {"frame"}).asInt(), 5);
  // It has begun to fall to the side.
  EXPECT_GT(member(last, {"nodes", "water", "linear_momentum"}).asArray()[0].asDouble(), 0);
  expectFailure(runWeir({"run", scene(), "--series", folder / "s.json"}), 2, {"s.json", ".jsonl"});
}

TEST_F(Cli, WritesASeriesAsATable) {
  const std::string series = folder / "series.csv";
  ASSERT_EQ(runWeir({"run", scene(), "--series", series, "--set", "water.spacing=0.05"}).code, 0);
  std::istringstream lines(readFile(series));
  const auto next = [&] {
    std::string line, field;
    std::getline(lines, line);
    std::vector<std::string> fields;
    for (std::istringstream rest(line + ","); std::getline(rest, field, ',');) fields.push_back(field);
    return fields;
  };
  const std::vector<std::string> names = next();
  const auto at = [&](const std::vector<std::string>& row, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    EXPECT_NE(found, names.end()) << name;
    return found != names.end() ? row.at(static_cast<std::size_t>(found - names.begin())) : std::string();
  };
  std::vector<std::vector<std::string>> rows;
  for (std::vector<std::string> row = next(); row.size() > 1; row = next()) rows.push_back(row);
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(at(rows[0], "ms_per_step"), "") << "there was no step before frame 0";
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k].size(), names.size());
    EXPECT_EQ(at(rows[k], "frame"), std::to_string(k));
    EXPECT_EQ(at(rows[k], "particles"), "64");
    EXPECT_NEAR(std::stod(at(rows[k], "time")), 0.02 * double(k), 1e-9);
    if (k > 0) {
      EXPECT_GT(std::stod(at(rows[k], "ms_per_step")), 0);
    }
  }
  EXPECT_GT(std::stod(at(rows[5], "water.linear_momentum.x")), 0) << "it has begun to fall to the side";
  EXPECT_GT(std::stod(at(rows[5], "water.kinetic_energy")), 0);
  EXPECT_GT(std::stod(at(rows[5], "water.compression.mean")), 0);
}

TEST_F(Cli, SetChangesTheTypeOfAModule) {
  const std::string stats = folder / "stats.json";
  const auto objective = [&](const char* type) {
    const ChildResult result =
        runWeir({"run", scene(), "--stats", stats, "--frames", "1", "--set",
                 std::string("water.solver.type=") + type, "--set", "water.solver.record_objective=true"});
    EXPECT_EQ(result.code, 0) << result.err;
    const Value v = parseJson(readFile(stats), "stats");
    return member(v, {"nodes", "water", "objective_by_iteration"}).asArray();
  };
  const auto ours = objective("SemiImplicitSolver"), pbf = objective("Pbf");
  EXPECT_EQ(ours.size(), 4u);
  EXPECT_EQ(pbf.size(), 4u);
  EXPECT_NE(ours.back(), pbf.back());
  expectFailure(runWeir({"run", scene(), "--set", "water.solver.type=Pbx"}), 3,
                {"--set water.solver.type=Pbx", "Pbx"});
}

TEST_F(Cli, SetFramesAndDurationOverrideTheScene) {
  const std::string stats = folder / "stats.json";
  ASSERT_EQ(runWeir({"run", scene(), "--stats", stats, "--set", "water.spacing=0.05", "--frames", "2"}).code,
            0);
  Value v = parseJson(readFile(stats), "stats");
  EXPECT_EQ(member(v, {"particles"}).asInt(), 64);
  EXPECT_EQ(member(v, {"frames"}).asInt(), 2);
  ASSERT_EQ(runWeir({"run", scene(), "--stats", stats, "--duration", "0.06"}).code, 0);
  v = parseJson(readFile(stats), "stats");
  EXPECT_EQ(member(v, {"frames"}).asInt(), 3);
}

TEST_F(Cli, QuietSaysNothing) {
  const ChildResult result = runWeir({"run", scene(), "--quiet"});
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.out + result.err, "");
}

TEST_F(Cli, UsageErrors) {
  expectFailure(runWeir({}), 2, {"no command is given", "run, sweep"});
  expectFailure(runWeir({"rum"}), 2, {"'rum'", "did you mean 'run'?"});
  expectFailure(runWeir({"run"}), 2, {"'weir run' needs SCENE"});
  expectFailure(runWeir({"run", scene(), "--spacing", "3"}), 2, {"'weir run' has no option '--spacing'"});
  expectFailure(runWeir({"run", scene(), "--vidoe=a.mp4"}), 2, {"'--vidoe'", "did you mean '--video'?"});
  expectFailure(runWeir({"run", scene(), "twice"}), 2, {"'weir run' does not take 'twice'"});
  expectFailure(runWeir({"run", scene(), "--device", "tpu"}), 2, {"tpu", "cpu"});
  expectFailure(runWeir({"run", scene(), "--set", "spacing"}), 2, {"spacing", "'='"});
  expectFailure(runWeir({"run", scene(), "--set", "spacing=1"}), 2, {"needs two names", "NODE.PARAM=VALUE"});
  expectFailure(runWeir({"run", scene(), "--frames", "-1"}), 2,
                {"--frames: '-1' is not a number of at least 0"});
  expectFailure(runWeir({"run", scene(), "--threads", "0"}), 2, {"--threads"});
  expectFailure(runWeir({"run", scene(), "--stats", folder / "stats.txt"}), 2, {"stats.txt", ".json"});
  expectFailure(runWeir({"run", scene(), "--stats", scene()}), 2, {"would overwrite the scene"});
  expectFailure(runWeir({"nodes", "ParticleFlud"}), 2, {"ParticleFlud", "did you mean 'ParticleFluid'?"});
}

TEST_F(Cli, SceneErrorsNameThePlace) {
  expectFailure(runWeir({"run", folder.write("empty.json", "")}), 3, {"empty.json:1:1"});
  expectFailure(runWeir({"run", folder.write("brackets.json", "{}")}), 3, {"brackets.json:1:1", "weir"});
  expectFailure(runWeir({"run", sceneWith("\"title\"", "\"titel\"")}), 3,
                {"scene.json:3", "titel", "did you mean 'title'?"});
}

TEST_F(Cli, UnknownTypesAreSuggested) {
  expectFailure(runWeir({"run", sceneWith("\"BoxSampler\"", "\"BoxSmpler\"")}), 3,
                {"scene.json:6", "/nodes/block/type", "BoxSmpler", "did you mean 'BoxSampler'?"});
  expectFailure(runWeir({"run", sceneWith("\"spacing\"", "\"spaceing\"")}), 3,
                {"scene.json:9", "/nodes/water/params", "spaceing", "did you mean 'spacing'?"});
}

TEST_F(Cli, WrongValuesAndLinks) {
  expectFailure(runWeir({"run", sceneWith("\"spacing\": 0.02", "\"spacing\": -0.02")}), 3,
                {"scene.json:9", "spacing", "-0.02", "above 0"});
  expectFailure(runWeir({"run", sceneWith("\"spacing\": 0.02", "\"spacing\": NaN")}), 3, {"scene.json:9"});
  expectFailure(runWeir({"run", sceneWith("\"spacing\": 0.02", "\"spacing\": 1e999")}), 3, {"scene.json:9"});
  expectFailure(
      runWeir({"run", sceneWith("tank.boundary -> water.boundaries", "tank.boundary -> water.initial")}), 3,
      {"tank.boundary", "water.initial", "Boundary", "ParticleBatch"});
  expectFailure(runWeir({"run", scene(), "--set", "water.spacing=-1"}), 3,
                {"--set water.spacing=-1", "above 0"});
  expectFailure(runWeir({"run", scene(), "--duration", "long"}), 3, {"--duration long"});
}

TEST_F(Cli, FilesThatAreNotThere) {
  expectFailure(runWeir({"run", folder / "none.json"}), 5, {"none.json"});
  expectFailure(runWeir({"run", folder.path()}), 5, {folder.path().c_str()});
  expectFailure(runWeir({"run", scene(), "--stats", folder / "none/stats.json"}), 5, {"there is no folder"});
  expectFailure(runWeir({"run", scene(), "--plugin", folder / "none.so"}), 5, {"none.so"});
}

TEST_F(Cli, ASceneWithoutNodesIsAnError) {
  expectFailure(runWeir({"run", scene(R"({"weir": 1})")}), 3, {"scene.json:1:1", "no \"nodes\""});
  expectFailure(runWeir({"run", scene(R"({"weir": 1, "nodes": {}})")}), 3,
                {"scene.json:1", "at least one node"});
}

TEST_F(Cli, AFluidThatStartsEmptyRuns) {
  const ChildResult result = runWeir(
      {"run",
       scene(R"({"weir": 1, "world": {"duration": 0.1}, "nodes": {"w": {"type": "ParticleFluid"}}})")});
  EXPECT_EQ(result.code, 0) << result.err;
}

TEST_F(Cli, ValidateChecksEveryScene) {
  const std::string good = scene();
  const std::string bad = folder.write("bad.json", "{\"weir\": 1, \"nodes\": []}");
  const ChildResult result = runWeir({"validate", bad, good});
  EXPECT_EQ(result.code, 3);
  EXPECT_EQ(result.out, good + ": valid\n");
  EXPECT_CONTAINS(result.err, "bad.json:1");
}

TEST_F(Cli, TheScenesOfTheProjectAreValid) {
  const std::string scenes = resourcesFolder() + "/scenes/";
  const ChildResult result = runWeir({"validate", scenes + "dam_break.json", scenes + "jet_fills_goblet.json",
                                      scenes + "benchmark_dam_break.json", scenes + "tank_at_rest.json"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

TEST_F(Cli, TheScenesOfThePaperAreValid) {
  std::vector<std::string> arguments{"validate"};
  for (const auto& entry : std::filesystem::directory_iterator(resourcesFolder() + "/scenes/paper"))
    arguments.push_back(entry.path().string());
  EXPECT_GT(arguments.size(), 5u);
  const ChildResult result = runWeir(arguments);
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

TEST_F(Cli, AMissingMeshIsFoundByValidateAndRun) {
  const std::string text = resourcesFolder() + "/scenes/mesh_in_tank.json";
  for (const char* command : {"validate", "run"})
    expectFailure(runWeir({command, text, "--set", "mesh.file=" + (folder / "none.obj")}), 5,
                  {"/nodes/mesh/params/file", "none.obj"});
}

TEST_F(Cli, NodesSchemaInfoAndCompletion) {
  const ChildResult nodes = runWeir({"nodes"});
  EXPECT_EQ(nodes.code, 0);
  for (const char* type : {"ParticleFluid", "StaticBoundary", "SquareEmitter", "TurningModel", "MeshFile",
                           "BoxSampler", "SphereSampler", "MeshSampler", "ParticleFile", "SemiImplicitSolver",
                           "AcceleratedSolver", "CircleEmitter", "MeshEmitter", "Sink", "Terrain"})
    EXPECT_CONTAINS(nodes.out, type);
  const ChildResult one = runWeir({"nodes", "ParticleFluid"});
  EXPECT_CONTAINS(one.out, "support_ratio");
  EXPECT_CONTAINS(one.out, "boundaries");
  for (const char* module :
       {"Xsph", "Pbf", "ViscositySolver", "SurfaceTension", "CapillaryForce", "VorticityConfinement", "Drag"})
    EXPECT_CONTAINS(one.out, module);
  const Value json = parseJson(runWeir({"nodes", "--json"}).out, "nodes");
  EXPECT_EQ(member(json, {"nodes", "ParticleFluid", "family"}).asString(), "FluidModule");
  const Value schema = parseJson(runWeir({"schema"}).out, "schema");
  EXPECT_NE(schema.find("$schema"), nullptr);
  EXPECT_CONTAINS(runWeir({"info"}).out, "cpu");
  EXPECT_CONTAINS(runWeir({"completion"}).out, "complete -o filenames -F _weir weir");
}

TEST_F(Cli, AnInterruptedRunEndsCleanly) {
  const std::string stats = folder / "stats.json";
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    ChildOptions options;
    bool sent = false;
    options.onStderr = [&](int pid, const std::string& err) {
      if (!sent && contains(err, "frame ")) sent = kill(pid, signal) == 0;
    };
    const ChildResult result = runWeir({"run", scene(), "--duration", "1000", "--stats", stats}, options);
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_FALSE(result.timedOut);
    EXPECT_EQ(member(parseJson(readFile(stats), "stats"), {"end"}).asString(), "interrupted");
  }
}

TEST_F(Cli, ASceneThatIsBeingSetUpIsLeftWhenTheRunIsInterrupted) {
  // Its particles are brought to rest before the first step, which takes minutes.
  const std::string slow =
      sceneWith("\"max\": [0.2, 0.2, 0.2]", "\"max\": [0.5, 0.5, 0.2], \"arrangement\": \"relaxed\"");
  for (const char* threads : {"1", "2"}) {
    bool asked = false;
    ChildOptions options;
    options.onStderr = [&](int pid, const std::string& err) {
      if (!asked && contains(err, "memory: ")) asked = ::kill(pid, SIGINT) == 0;
    };
    const ChildResult result =
        runWeir({"run", slow, "--device", "cpu", "--threads", threads, "--set", "water.spacing=0.01", "--set",
                 "water.rest_steps=100000", "--stats", folder / "stats.json"},
                options);
    EXPECT_TRUE(asked) << result.err;
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_CONTAINS(result.err, "interrupted before the first step");
    EXPECT_FALSE(std::filesystem::exists(folder / ".stats.json.lock"));
  }
}

TEST_F(Cli, AnOutputThatCannotBeWrittenIsAnError) {
  expectFailure(runWeir({"run", scene(), "--stats", folder / "missing/stats.json"}), 5,
                {"--stats", "there is no folder", "missing"});
  expectFailure(runWeir({"run", scene(), "--stats", "/proc/stats.json"}), 5, {"/proc/stats.json"});
  const SmallDisk disk("4k");  // one block
  if (!disk.isThere()) GTEST_SKIP() << "this user may not mount a file system";
  std::ofstream(disk / "fills_it") << std::string(4096, 'x');
  expectFailure(runWeir({"run", scene(), "--stats", disk / "stats.json"}), 5,
                {"stats.json", "No space left on device"});
  EXPECT_FALSE(std::filesystem::exists(disk / "stats.json")) << "half a file is none";
}

TEST_F(Cli, ADivergingRunFailsWithAHint) {
  const ChildResult result = runWeir({"run", scene(), "--set", "world.gravity=[0, -1e30, 0]"});
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_CONTAINS(result.err, "water");
}

TEST_F(Cli, ResultsDoNotDependOnTheNumberOfThreads) {
  std::vector<std::string> states;
  for (const char* threads : {"1", "2", "4"}) {
    const std::string stats = folder / "stats.json";
    ASSERT_EQ(runWeir({"run", scene(), "--stats", stats, "--device", "cpu", "--threads", threads}).code, 0);
    states.push_back(writeJson(member(parseJson(readFile(stats), "stats"), {"nodes"})));
  }
  EXPECT_EQ(states[0], states[1]);
  EXPECT_EQ(states[0], states[2]);
}

TEST_F(Cli, ASceneWithShorthandGivesTheSameResultsAsThePlainOne) {
  std::vector<std::string> states;
  const auto run = [&](const std::string& text, const std::vector<std::string>& more) {
    const std::string stats = folder / "stats.json";
    std::vector<std::string> arguments{"run", scene(text), "--frames", "2", "--stats", stats};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ChildResult result = runWeir(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    states.push_back(writeJson(member(parseJson(readFile(stats), "stats"), {"nodes"})));
  };
  run(std::string(kDamBreak), {});
  folder.write("tank.json",
               R"({ "type": "StaticBoundary", "params": { "shape": "box", "inverted": true } })");
  run(R"({
    "weir": 1, // comments
    "let": { "spacing": 0.05, "width": "=10*spacing" },
    "world": { "dt": "2 ms", "duration": 0.1, "frame_rate": "50 Hz" },
    "nodes": {
      "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": ["=width", "20 cm", "=width"] } },
      "tank": { "$include": "tank.json", "params": { "min": [0, 0, 0], "max": [0.5, 0.5, "=width"] } },
      "water": { "type": "ParticleFluid", "params": { "spacing": "=spacing" } },
    },
    "links": [ "block.particles -> water.initial", "tank.boundary -> water.boundaries" ],
  })",
      {"--set", "let.spacing=0.02"});
  EXPECT_EQ(states[0], states[1]);
}

TEST_F(Cli, MistakesInShorthandNameTheLineAsWritten) {
  const ChildResult result =
      runWeir({"validate", sceneWith("\"spacing\": 0.02", "/* m */\n\"spacing\": \"=spacng\"")});
  expectFailure(result, 3, {"scene.json:10:12: /nodes/water/params/spacing", "names 'spacng'"});
}

TEST_F(Cli, StepsFollowTheMotionIfASceneAsksForIt) {
  const std::string file = sceneWith("\"dt\": 0.002", "\"dt\": 0.01, \"cfl\": 0.4");
  const std::string stats = folder / "stats.json";
  std::vector<std::string> states;
  for (const char* threads : {"1", "3"}) {
    const ChildResult result =
        runWeir({"run", file, "--stats", stats, "--device", "cpu", "--threads", threads});
    ASSERT_EQ(result.code, 0) << result.err;
    const Value v = parseJson(readFile(stats), "stats");
    EXPECT_EQ(member(v, {"frames"}).asInt(), 5);
    EXPECT_EQ(member(v, {"simulated_seconds"}).asDouble(), 5 / 50.0);
    EXPECT_EQ(member(v, {"dt"}).asDouble(), 0.01);
    const double shortest = member(v, {"time_step", "shortest"}).asDouble();
    // It falls for 0.1 s, and meets the walls: at 1 to 4 m/s, dt is 0.4 · 0.02 m over that.
    EXPECT_GT(shortest, 0.002);
    EXPECT_LT(shortest, 0.01);
    EXPECT_NEAR(member(v, {"time_step", "longest"}).asDouble(), 0.01, 1e-12);
    EXPECT_EQ(member(v, {"modules_ms", "time step", "calls"}).asInt(), member(v, {"steps"}).asInt());
    states.push_back(writeJson(member(v, {"nodes"})) + writeJson(member(v, {"time_step"})));
  }
  EXPECT_EQ(states[0], states[1]);
}

TEST_F(Cli, WrongStepSettingsNameTheirPlace) {
  expectFailure(runWeir({"run", sceneWith("\"dt\": 0.002", "\"cfl\": -0.4")}), 3,
                {"scene.json:4", "/world/cfl", "-0.4", "above 0"});
  expectFailure(runWeir({"validate", sceneWith("\"dt\": 0.002", "\"cfl\": \"fast\"")}), 3,
                {"scene.json:4", "/world/cfl", "fast"});
  expectFailure(runWeir({"validate", scene(), "--set", "world.min_dt=0.001"}), 3, {"min_dt", "without cfl"});
  expectFailure(runWeir({"validate", scene(), "--set", "world.cfl=1", "--set", "world.min_dt=1e-14"}), 3,
                {"min_dt", "steps in a frame"});
}

TEST_F(Cli, TooFastASceneIsSlowedDownToMinDtAndToldSo) {
  const ChildResult result =
      runWeir({"run", scene(), "--set", "world.cfl=0.01", "--set", "world.min_dt=0.001", "--quiet"});
  EXPECT_EQ(result.code, 0);
  EXPECT_CONTAINS(result.err, "steps were longer than cfl allows");
  EXPECT_CONTAINS(result.err, "min_dt");
}

TEST_F(Cli, WarnsBeforeTheRunOfWhatIsKnownToGoWrong) {
  // c² = 1000 m²/s², so S = 1000·(0.01/0.02)².
  const ChildResult result = runWeir({"run", scene(), "--set", "world.dt=0.01", "--set",
                                      "water.solver.type=SemiImplicitSolver", "--frames", "0", "--quiet"});
  EXPECT_EQ(result.code, 0);
  EXPECT_CONTAINS(result.err, "warning: node 'water', module 'solver': S = (c·dt/d)² = 250 ");
  EXPECT_EQ(result.err.find("warning", 10), std::string::npos) << result.err;
}

}  // namespace
}  // namespace weir::test
