// Runs of `weir run --ranks N`, whose files are compared.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/scene/scene_file.h"
#include "tests/plugins/outputs/written_run.h"
#include "tests/support/child_process.h"
#include "tests/support/find_program.h"

namespace weir::test {

/// All that is written, by its path in the folder of the run.
using Files = std::map<std::string, std::string>;

struct Outcome {
  ChildResult result;
  Files files;
  Value statistics;
};

class RanksTest : public testing::Test {
 protected:
  /// The scene, the dam break if there is none, with what is changed.
  Outcome run(const std::string& name, const std::vector<std::string>& changes,
              const std::vector<std::string>& more, int processes = 1) const {
    const std::string to = folder_ / name;
    std::filesystem::create_directory(to);
    std::vector<std::string> arguments{"run",
                                       scene_.empty() ? resourcesFolder() + "/scenes/dam_break.json" : scene_,
                                       "--quiet",
                                       "--duration",
                                       duration_,
                                       "--ply-particles",
                                       to + "/ply",
                                       "--stats",
                                       to + "/stats.json",
                                       "--series",
                                       to + "/series.jsonl",
                                       "--export",
                                       to + "/export.vtkhdf"};
    arguments.insert(arguments.end(), rest_.begin(), rest_.end());
    for (const std::string& change : changes) arguments.insert(arguments.end(), {"--set", change});
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), device_.begin(), device_.end());
    Outcome run{.result = processes == 1 ? runWeir(arguments) : runByMpi(processes, std::move(arguments))};
    if (run.result.code != 0) return run;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(to + "/ply"))
      if (entry.is_regular_file())
        run.files[entry.path().lexically_relative(to).string()] = readFile(entry.path().string());
    run.statistics = parseJson(readFile(to + "/stats.json"), "stats.json");
    return run;
  }

  /// Takes five frames and saves the fourth, without outputs, which would have to be there at a resume.
  ChildResult save(const std::string& checkpoint, const std::string& change,
                   const std::vector<std::string>& where) const {
    std::vector<std::string> arguments{
        "run", scene_,         "--quiet",  "--duration",         duration_, "--set", change, "--frames",
        "5",   "--checkpoint", checkpoint, "--checkpoint-every", "4"};
    arguments.insert(arguments.end(), where.begin(), where.end());
    arguments.insert(arguments.end(), rest_.begin(), rest_.end());
    return runWeir(arguments);
  }

  static ChildResult runByMpi(int processes, std::vector<std::string> arguments, ChildOptions options = {}) {
    arguments.insert(arguments.begin(), {"-n", std::to_string(processes), weirProgram()});
    // Of Open MPI, which asks whether one knows what one does.
    options.environment = {{"OMPI_ALLOW_RUN_AS_ROOT", "1"},
                           {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"},
                           {"OMPI_MCA_rmaps_base_oversubscribe", "1"}};
    return runChild(findProgram("mpirun"), arguments, options);
  }
  static bool hasMpi() {
    return !findProgram("mpirun").empty() &&
           std::filesystem::exists(buildFolder() + "/lib/weir/plugins/weir_mpi.so");
  }

  void expectSameForAnyNumber(const std::vector<std::string>& changes,
                              const std::vector<std::string>& numbers = {"2", "4"}) const {
    const Outcome one = run("1", changes, {"--ranks", "1"});
    ASSERT_EQ(one.result.code, 0) << one.result.err;
    ASSERT_GE(one.files.size(), 10u);
    for (const std::string& ranks : numbers) {
      const Outcome several = run(ranks, changes, {"--ranks", ranks});
      ASSERT_EQ(several.result.code, 0) << several.result.err;
      ASSERT_EQ(several.files.size(), one.files.size());
      for (const auto& [file, bytes] : one.files)
        EXPECT_TRUE(several.files.at(file) == bytes) << file << " with " << ranks << " ranks";
      EXPECT_EQ(writeJson(*several.statistics.find("nodes")), writeJson(*one.statistics.find("nodes")))
          << ranks << " ranks";
      expectSameSeries(folder_ / "1/series.jsonl", folder_ / (ranks + "/series.jsonl"));
      expectSameExports(folder_ / "1/export.vtkhdf", folder_ / (ranks + "/export.vtkhdf"));
    }
  }

  /// The frames that a resumed run has written are those of the whole one.
  static void expectSameEnd(const Outcome& resumed, const Outcome& whole, const std::string& what) {
    ASSERT_EQ(resumed.result.code, 0) << resumed.result.err;
    EXPECT_GE(resumed.files.size(), 3u) << what;
    for (const auto& [file, bytes] : resumed.files)
      EXPECT_TRUE(whole.files.at(file) == bytes) << file << ", " << what;
    EXPECT_EQ(writeJson(*resumed.statistics.find("nodes")), writeJson(*whole.statistics.find("nodes")))
        << what;
  }

  static const Value& fluidOf(const Outcome& run) { return *run.statistics.find("nodes")->find("water"); }

  TemporaryFolder folder_;
  std::string scene_, duration_ = "0.3";  // s
  std::vector<std::string> device_;       // how to ask for another than the CPU
  // Free blocks would not come to rest in 3,000 steps, which are many times what comes after. Tests of where
  // water comes to rest have their own numbers.
  std::vector<std::string> rest_{"--set", "water.rest_steps=20"};
};

inline constexpr const char* kCoarse = "water.spacing=0.05";

/// A jet that fills a tank with a hole, from nothing; gauges and a surface look at it.
inline constexpr const char* kJet = R"({
  "weir": 1,
  "world": { "dt": 0.002, "frame_rate": 30, "duration": 0.6 },
  "nodes": {
    "jet": { "type": "CircleEmitter",
             "params": { "position": [0.3, 0.6, 0.25], "rotation": [0, 0, 20], "radius": 0.11, "speed": 2 } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [1, 1, 0.5], "inverted": true } },
    "hole": { "type": "Sink", "params": { "min": [0.8, 0, 0], "max": [1, 0.1, 0.5] } },
    "point": { "type": "Gauge", "params": { "shape": "point", "position": [0.3, 0.5, 0.25] } },
    "box": { "type": "Gauge", "params": { "shape": "box", "min": [0, 0, 0], "max": [0.5, 1, 0.5] } },
    "surface": { "type": "FluidSurface" },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.04, "support_ratio": 1.5 } }
  },
  "links": ["jet.particles -> water.emitters", "tank.boundary -> water.boundaries", "hole.sink -> water.sinks",
            "water.fluid -> point.particles", "water.fluid -> box.particles", "water.fluid -> surface.fluid"]
})";

}  // namespace weir::test
