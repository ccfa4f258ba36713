// The commands for scene files, as a user runs them: weir scenes, format, upgrade and explain.
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kDamBreak = R"({
  "weir": 1,
  "title": "A small dam break",
  "let": { "spacing": 0.02 },  // m
  "world": { "dt": "2 ms", "duration": 0.1, "frame_rate": 50 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.2, "=10*spacing", 0.2] } },
    "tank": {
      "type": "StaticBoundary",
      "params": { "shape": "box", "min": [0, 0, 0], "max": [0.5, 0.5, 0.2], "inverted": true }
    },
    "water": { "type": "ParticleFluid", "params": { "spacing": "=spacing" } }
  },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"]
}
)";

class SceneCommands : public testing::Test {
 protected:
  static void expectFailure(const ChildResult& result, int code, std::initializer_list<const char*> parts) {
    EXPECT_EQ(result.code, code) << result.err;
    for (const char* part : parts) EXPECT_CONTAINS(result.err, part);
    EXPECT_EQ(result.err.find("mistake in the program"), std::string::npos) << result.err;
  }
  /// What every command that reads scene files does with what is none.
  void expectClearErrors(const std::string& command) const {
    expectFailure(runWeir({command, folder / "none.json"}), 5, {"none.json", "No such file"});
    expectFailure(runWeir({command, folder.path()}), 5, {"it is a folder"});
    expectFailure(runWeir({command, folder.write("text.json", "Once upon a time")}), 3, {"text.json:1:1"});
    expectFailure(runWeir({command, folder.write("cut.json", "{\n  \"weir\": 1,")}), 3, {"cut.json:2:13"});
    expectFailure(runWeir({command, folder.write("binary.json", std::string("\0\xff\x01", 3))}), 3,
                  {"binary.json:1:1"});
    EXPECT_EQ(readFile(folder / "text.json"), "Once upon a time");
  }
  /// A scene with this module "solver" of its fluid, as a text of its own lines.
  static std::string withSolver(const std::string& solver) {
    return "{\n  \"weir\": 1,\n  \"nodes\": {\n    \"water\": {\n      \"type\": \"ParticleFluid\",\n"
           "      \"modules\": {\n        \"solver\": " +
           solver + "\n      }\n    }\n  }\n}\n";
  }
  /// Upgrades a scene, and expects that the result is one that nothing is to be said of.
  std::string upgraded(const std::string& text) const {
    const std::string file = folder.write("old.json", text);
    const ChildResult check = runWeir({"upgrade", "--check", file});
    EXPECT_EQ(check.code, 1) << check.err;
    EXPECT_EQ(readFile(file), text);
    const ChildResult result = runWeir({"upgrade", file});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.out, check.out);
    EXPECT_EQ(runWeir({"validate", file}).err, "");
    const ChildResult again = runWeir({"upgrade", "--check", file});
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(again.out, "");
    return readFile(file);
  }

  TemporaryFolder folder;
};

TEST_F(SceneCommands, ScenesListsWhatComesWithWeir) {
  const ChildResult list = runWeir({"scenes"});
  ASSERT_EQ(list.code, 0) << list.err;
  EXPECT_EQ(list.err, "");
  EXPECT_CONTAINS(list.out, "dam_break\n    A dam breaks; up to ");
  EXPECT_CONTAINS(list.out, "A block of water falls over in a tank.");
  EXPECT_CONTAINS(list.out, "gallery/goblet\n");
  EXPECT_EQ(list.out.find("templates"), std::string::npos);
  const ChildResult one = runWeir({"scenes", "gallery/goblet"});
  EXPECT_CONTAINS(one.out, "share/weir/scenes/gallery/goblet.json");
}

TEST_F(SceneCommands, AllScenesAreKnownByTheirNames) {
  std::vector<std::string> arguments{"validate"};
  const fs::path scenes = buildFolder() + "/share/weir/scenes";
  for (const auto& entry : fs::recursive_directory_iterator(scenes))
    if (entry.path().extension() == ".json" && entry.path().filename() != "index.json" &&
        entry.path().filename() != "mesh_in_tank.json")  // whose mesh is the user's
      arguments.push_back(entry.path().lexically_relative(scenes).replace_extension().string());
  EXPECT_GT(arguments.size(), 30u);
  const ChildResult result = runWeir(arguments);
  EXPECT_EQ(result.code, 0) << result.err;
  for (std::size_t i = 1; i < arguments.size(); ++i) EXPECT_CONTAINS(result.out, arguments[i] + ": valid\n");
}

TEST_F(SceneCommands, ASceneIsRunByItsNameUnlessThereIsSuchAFile) {
  const std::vector<std::string> run{"run", "dam_break", "--frames", "0", "--set", "water.spacing=0.05"};
  ChildOptions here;
  here.folder = folder.path();
  const ChildResult installed = runWeir(run, here);
  EXPECT_EQ(installed.code, 0) << installed.err;
  EXPECT_CONTAINS(installed.err, "A dam breaks on ");
  folder.write("dam_break", std::string(kDamBreak));
  EXPECT_CONTAINS(runWeir(run, here).err, "A small dam break on ");
}

TEST_F(SceneCommands, NamesThatAreNoneAreSuggested) {
  expectFailure(runWeir({"run", "dam_brek"}), 5, {"no file 'dam_brek'", "did you mean 'dam_break'?"});
  expectFailure(runWeir({"validate", "goblet"}), 5, {"did you mean 'gallery/goblet'?"});
  ChildOptions here;
  here.folder = folder.path();
  folder.write("goblet.json", std::string(kDamBreak));
  expectFailure(runWeir({"run", "goblet"}, here), 5, {"did you mean 'goblet.json'?"});
  expectFailure(runWeir({"run", "dam_break.json"}), 5, {"dam_break.json", "No such file"});
  expectFailure(runWeir({"scenes", "dam_brek"}), 2, {"did you mean 'dam_break'?"});
  expectFailure(runWeir({"scenes", "../scenes/dam_break"}), 2, {"there is no scene"});
}

TEST_F(SceneCommands, ACopyOfASceneIsOnesOwn) {
  const std::string file = folder / "own.json";
  const ChildResult result = runWeir({"scenes", "stirrer", "--copy", file});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out, file + "\n");
  EXPECT_EQ(readFile(file), readFile(buildFolder() + "/share/weir/scenes/stirrer.json"));
  EXPECT_EQ(runWeir({"validate", file}).code, 0);
  folder.write("own.json", "mine");
  expectFailure(runWeir({"scenes", "stirrer", "--copy", file}), 5, {"own.json", "would be overwritten"});
  EXPECT_EQ(readFile(file), "mine");
  expectFailure(runWeir({"scenes", "--copy", folder / "x.json"}), 2, {"--copy"});
  expectFailure(runWeir({"scenes", "stirrer", "--copy", folder / "none/x.json"}), 5, {"there is no folder"});
}

TEST_F(SceneCommands, FormatWritesTheLayoutOnce) {
  const std::string messy = folder.write("messy.json", R"({"weir": 1, // version
"let": {"spacing": 2e-2,},
    "nodes": {
      "note": "some", "w_{i}": {"repeat": 2, "node": {"type": "ParticleFluid",
        "params": {"spacing": "=spacing", /* m */ }}}}
 })");
  const std::string layout = R"({
  "weir": 1,  // version
  "let": { "spacing": 2e-2 },
  "nodes": {
    "note": "some",
    "w_{i}": {
      "repeat": 2,
      "node": { "type": "ParticleFluid", "params": { "spacing": "=spacing" /* m */ } }
    }
  }
}
)";
  const std::string before = readFile(messy);
  const ChildResult check = runWeir({"format", "--check", messy});
  EXPECT_EQ(check.code, 1);
  EXPECT_EQ(check.out, messy + ": has another layout\n");
  EXPECT_EQ(runWeir({"format", "--stdout", messy}).out, layout);
  EXPECT_EQ(readFile(messy), before);
  const ChildResult result = runWeir({"format", messy});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out, messy + ": formatted\n");
  EXPECT_EQ(readFile(messy), layout);
  EXPECT_EQ(runWeir({"format", messy}).out, "");
  EXPECT_EQ(runWeir({"format", "--check", messy}).code, 0);
  EXPECT_EQ(runWeir({"validate", messy}).code, 0);
}

TEST_F(SceneCommands, FormatKeepsLinksAndPermissions) {
  const std::string file = folder.write("scene.json", "{\"weir\":1}");
  const auto mode = fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read;
  fs::permissions(file, mode);
  fs::create_symlink("scene.json", folder / "link.json");
  EXPECT_EQ(runWeir({"format", folder / "link.json"}).code, 0);
  EXPECT_TRUE(fs::is_symlink(folder / "link.json"));
  EXPECT_EQ(readFile(file), "{\n  \"weir\": 1\n}\n");
  EXPECT_EQ(fs::status(file).permissions(), mode);
}

TEST_F(SceneCommands, FormatTellsOfWhatItCannotDo) {
  expectClearErrors("format");
  const std::string locked = folder.write("locked.json", "{\"weir\":1}");
  fs::permissions(locked, fs::perms::owner_read);
  expectFailure(runWeir({"format", locked}), 5, {"locked.json", "read-only"});
  EXPECT_EQ(readFile(locked), "{\"weir\":1}");
  const std::string good = folder.write("good.json", "{\"weir\":1}");
  expectFailure(runWeir({"format", folder / "none.json", good}), 5, {"none.json"});
  EXPECT_EQ(readFile(good), "{\n  \"weir\": 1\n}\n") << "the others are formatted";
  expectFailure(runWeir({"format", "--stdout", good, locked}), 2, {"--stdout"});
  expectFailure(runWeir({"format", "--stdout", "--check", good}), 2, {"--check"});
  expectFailure(runWeir({"format"}), 2, {"'weir format' needs "});
}

TEST_F(SceneCommands, UpgradeRenamesWhatOtherModulesHaveNow) {
  EXPECT_EQ(upgraded(withSolver(R"({
          // until it is still
          "params": {
            "iterations": 20, // at most
            "tolerance": 1e-3 /* of the density */
          }
        })")),
            withSolver(R"({
          "type": "AcceleratedSolver",
          // until it is still
          "params": {
            "max_iterations": 20, // at most
            "tolerance": 1e-3, /* of the density */
            "acceleration": "none"
          }
        })"));
}

TEST_F(SceneCommands, UpgradeSaysWhatItChanged) {
  const std::string file = folder.write(
      "old.json",
      withSolver(R"({ "type": "SemiImplicitSolver", "params": { "tolerance": 0.01, "iterations": 9 } })"));
  EXPECT_EQ(runWeir({"upgrade", file}).out,
            file + ":7:29: \"SemiImplicitSolver\" becomes \"AcceleratedSolver\"\n" + file +
                ":7:96: \"iterations\" becomes \"max_iterations\"\n" + file +
                ":7:61: \"acceleration\": \"none\" is added\n");
}

TEST_F(SceneCommands, UpgradeLeavesOutWhatHasNoEffect) {
  const auto papers = [&](const std::string& params) {
    return withSolver(R"({ "type": "SemiImplicitSolver", "params": )" + params + " }");
  };
  EXPECT_EQ(upgraded(papers(R"({ "iterations": 5, "acceleration": "none" })")),
            papers(R"({ "iterations": 5 })"));
  EXPECT_EQ(upgraded(papers(R"({ "tolerance": null, "iterations": 5 })")), papers(R"({ "iterations": 5 })"));
  EXPECT_EQ(upgraded(papers(R"({ "tolerance": null, "acceleration": "none" })")), papers("{ }"));
  EXPECT_EQ(upgraded(papers("{\n  \"iterations\": 5, // few\n  \"tolerance\": null // none\n}")),
            papers("{\n  \"iterations\": 5 // few\n  // none\n}"));
}

TEST_F(SceneCommands, UpgradeNamesTheFormThatAStrengthOfXsphIsOf) {
  const auto papers = [&](const std::string& params) {
    return withSolver(R"({ "type": "SemiImplicitSolver" },
        "viscosity": { "params": { )" +
                      params + " } }");
  };
  EXPECT_EQ(upgraded(papers(R"("strength": 0.3)")), papers(R"("strength": 0.3, "form": "explicit")"));
}

TEST_F(SceneCommands, UpgradeNamesTheSolverThatIterationsAreOf) {
  EXPECT_EQ(upgraded(withSolver(R"({ "params": { "iterations": 5 } })")),
            withSolver(R"({ "type": "SemiImplicitSolver", "params": { "iterations": 5 } })"));
}

TEST_F(SceneCommands, UpgradeReachesIncludedFilesAndRepetitions) {
  const std::string part =
      folder.write("solver.json", "{ \"params\": { \"tolerance\": \"=t\", \"iterations\": 9 } } // a part\n");
  const std::string scene = R"({
  "weir": 1,
  "let": { "t": 0.01 },
  "nodes": {
    "water_{i}": {
      "repeat": 3,
      "node": {
        "type": "ParticleFluid",
        "modules": { "solver": { "$include": "solver.json" } }
      }
    }
  }
}
)";
  EXPECT_CONTAINS(upgraded(scene),
                  "\"solver\": { \"type\": \"AcceleratedSolver\", \"$include\": \"solver.json\" }");
  EXPECT_CONTAINS(readFile(part), "\"tolerance\": \"=t\"");
  EXPECT_CONTAINS(readFile(part), "// a part\n");
}

TEST_F(SceneCommands, UpgradeRefusesWhatOneTextCannotSay) {
  const std::string text =
      R"({ "weir": 1, "nodes": { "w_{i}": { "repeat": 2, "node": { "type": "ParticleFluid",
    "modules": { "solver": { "params": { "iterations": 3, "neighbor_searches": "=i+1" } } } } } } })";
  const std::string file = folder.write("old.json", text);
  expectFailure(runWeir({"upgrade", file}), 3, {"old.json:2:", "several modules"});
  EXPECT_EQ(readFile(file), text);
}

TEST_F(SceneCommands, UpgradeTellsOfWhatItCannotRead) {
  expectClearErrors("upgrade");
  const std::string unknown = withSolver(R"({ "params": { "tolerence": 0.01 } })");
  const std::string file = folder.write("unknown.json", unknown);
  expectFailure(runWeir({"upgrade", file}), 3, {"unknown.json:7", "tolerence"});
  EXPECT_EQ(readFile(file), unknown);
  folder.write("a.json", R"({ "$include": "b.json", "weir": 1 })");
  folder.write("b.json", R"({ "$include": "a.json" })");
  expectFailure(runWeir({"upgrade", folder / "a.json"}), 3,
                {"files include each other: a.json -> b.json -> a.json"});
  const std::string locked =
      folder.write("locked.json", withSolver(R"({ "params": { "tolerance": 0.01, "iterations": 9 } })"));
  fs::permissions(locked, fs::perms::owner_read);
  const ChildResult refused = runWeir({"upgrade", locked});
  expectFailure(refused, 5, {"locked.json", "read-only"});
  EXPECT_EQ(refused.out, "");
}

TEST_F(SceneCommands, UpgradeChangesAllFilesOfASceneOrNone) {
  const std::string part = R"({ "params": { "tolerance": 0.01, "iterations": 9 } })";
  folder.write("a_part.json", part);
  const std::string scene = folder.write("scene.json", withSolver(R"({ "$include": "a_part.json" })"));
  fs::permissions(scene, fs::perms::owner_read);
  expectFailure(runWeir({"upgrade", scene}), 5, {"scene.json", "read-only"});
  EXPECT_EQ(readFile(folder / "a_part.json"), part);
  fs::permissions(scene, fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(runWeir({"upgrade", scene}).code, 0);
  EXPECT_CONTAINS(readFile(folder / "a_part.json"), "max_iterations");
  EXPECT_EQ(runWeir({"validate", scene}).err, "");
}

TEST_F(SceneCommands, ExplainTellsWhatASceneWillDo) {
  const ChildResult result =
      runWeir({"explain", folder.write("s.json", std::string(kDamBreak)), "--device", "cpu"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* part :
       {"A small dam break\n", "It simulates 0.1 s in 5 frames, 50 a second.",
        "Each frame takes 10 steps of 2 ms", "block (BoxSampler): fills a box with particles.",
        "block -> water.initial: particles that are there from the start.",
        "tank -> water.boundaries: solids and containers that the fluid does not enter.",
        "Particles: 1,000 at the start, at most 1,000.", "Memory: at most ", "There are no warnings."})
    EXPECT_CONTAINS(result.out, part);
  EXPECT_CONTAINS(runWeir({"explain", folder / "s.json", "--set", "let.spacing=0.04"}).out, "at most 250.");
}

TEST_F(SceneCommands, ExplainCountsTheLeastNumberOfStepsThatVaryFrameByFrame) {
  const std::string file = folder.write("s.json", std::string(kDamBreak));
  const ChildResult result = runWeir({"explain", file, "--set", "world.cfl=0.4", "--set", "world.dt=0.003"});
  EXPECT_EQ(result.code, 0) << result.err;
  // 20 ms are seven steps of at most 3 ms, and there are five such frames.
  EXPECT_CONTAINS(result.out, "so there are at least 35.");
}

TEST_F(SceneCommands, ExplainGivesTheWarningsOfARun) {
  const std::string file = folder.write("s.json", std::string(kDamBreak));
  const ChildResult result =
      runWeir({"explain", file, "--set", "tank.max=[0.5,0.5,0.05]", "--set", "block.max=[0.2,0.2,0.05]"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_CONTAINS(result.out, "Warnings:\n");
  EXPECT_CONTAINS(result.out, "node 'tank': the room inside is 2.5 spacings thick");
}

TEST_F(SceneCommands, ExplainMeasuresTheTimeOfSteps) {
  const std::string file = folder.write("s.json", std::string(kDamBreak));
  const ChildResult result = runWeir({"explain", file, "--measure", "--device", "cpu", "--threads", "2"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_CONTAINS(result.out, "Particles: 1,000 at the start");
  EXPECT_CONTAINS(result.out, " steps took ");
  EXPECT_CONTAINS(result.out, "50 like these take ");
}

TEST_F(SceneCommands, ExplainTellsOfWhatItCannotRead) {
  expectClearErrors("explain");
  expectFailure(runWeir({"explain", "mesh_in_tank"}), 3, {"mesh"});
  expectFailure(runWeir({"explain", "dam_break", "--set", "water.spacing=-1"}), 3,
                {"--set water.spacing=-1"});
}

}  // namespace
}  // namespace weir::test
