// Damaged scene files through the program itself, with all nodes and plugins it has: each is valid, or is
// refused with a message that names the place; nothing crashes or hangs.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <sstream>

#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"
#include "tests/support/scene_mutator.h"

namespace weir::test {
namespace {

constexpr int kMutants = 11000, kPerCall = 500;

/// All nodes in one scene, small enough to run in no time: of coarse meshes, because hundreds of mutants make
/// their distance fields.
constexpr const char* kEveryNode = R"({
  "weir": 1,
  "world": { "gravity": { "keyframes": [[0, [0, -9.8, 0]], [0.01, [0, -5, 0]]] },
             "dt": 0.002, "frame_rate": 100, "duration": 0.02, "seed": 3 },
  "nodes": {
    "nozzle": { "type": "SquareEmitter", "params": { "position": [0, 0.9, 0], "width": 0.2, "height": 0.2 } },
    "pipe": { "type": "CircleEmitter", "params": { "position": [0.3, 0.9, 0], "radius": 0.06, "jitter": 0.1,
                                                  "speed": { "keyframes": [[0, 0.5], [0.01, 2]] } } },
    "spring": { "type": "MeshEmitter", "params": { "speed": 0.5, "max_particles": 50 } },
    "cup": { "type": "TurningModel",
             "params": { "segments": 12,
                         "profile": [[0, 0], [0.2, 0], [0.2, 0.3], [0.15, 0.3], [0.15, 0.05], [0, 0.05]] } },
    "hill": { "type": "Terrain", "params": { "size": [0.6, 0.5], "cells": 8, "profile": [[-0.3, 0.1], [0.2, 0.05]],
                                            "channel_width": 0.2, "channel_depth": 0.03, "roughness": 0.02,
                                            "rocks": 2, "rock_range": [-0.1, 0.2] } },
    "glass": { "type": "StaticBoundary", "params": { "friction": 0.1, "cell_size": 0.05 } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [-0.5, 0, -0.5], "max": [0.5, 1, 0.5], "inverted": true } },
    "block": { "type": "BoxSampler", "params": { "min": [-0.4, 0.4, -0.4], "max": [-0.1, 0.7, 0.4] } },
    "ball": { "type": "SphereSampler", "params": { "center": [0.2, 0.6, 0], "radius": 0.15 } },
    "inside": { "type": "MeshSampler" },
    "drain": { "type": "Sink", "params": { "min": [0.3, 0, -0.5], "max": [0.5, 0.1, 0.5] } },
    "water": {
      "type": "ParticleFluid",
      "params": { "spacing": 0.05, "support_ratio": 1.5, "calibration": "lattice", "bulk_modulus": 100000 },
      "modules": { "solver": { "params": { "iterations": 3 } },
                   "viscosity": { "params": { "rate": { "keyframes": [[0, 100], [1, 200]] } } } }
    }
  },
  "links": [
    "nozzle.particles -> water.emitters", "pipe.particles -> water.emitters", "spring.particles -> water.emitters",
    "cup.surface -> spring.surface", "cup.surface -> glass.meshes", "cup.surface -> inside.surface",
    "inside.particles -> water.initial", "block.particles -> water.initial", "ball.particles -> water.initial",
    "cup.surface -> drain.meshes", "hill.surface -> glass.meshes", "drain.sink -> water.sinks",
    "glass.boundary -> water.boundaries", "tank.boundary -> water.boundaries"
  ],
  "render": { "width": 64, "height": 36, "color": { "by": "speed", "range": [0, 3] } }
})";

std::vector<std::string> scenesOfTheProject() {
  std::vector<std::string> texts{kEveryNode};
  for (const auto& entry : std::filesystem::directory_iterator(resourcesFolder() + "/scenes"))
    if (entry.path().extension() == ".json") texts.push_back(readFile(entry.path()));
  std::sort(texts.begin() + 1, texts.end());  // folders have no order
  return texts;
}

/// The file that a line of the program's output is about: what stands before the first colon.
std::string fileOf(const std::string& text) {
  return text.substr(0, text.find(':'));
}

TEST(SceneFileMutation, EveryMutantIsValidOrRefusedWithItsPlace) {
  const SceneMutator mutator(scenesOfTheProject());
  std::map<std::string, int> outcomes;
  for (int first = 0; first < kMutants && !HasFailure(); first += kPerCall) {
    const TemporaryFolder folder;
    std::vector<std::string> arguments{"validate"};
    for (int seed = first; seed < first + kPerCall; ++seed)
      arguments.push_back(folder.write("m" + std::to_string(seed) + ".json",
                                       mutator.mutate(static_cast<std::uint64_t>(seed))));
    const ChildResult result = runWeir(arguments);
    ASSERT_TRUE(result.code == 3 || result.code == 5) << result.code << " " << result.signal << result.err;
    std::map<std::string, int> answers;
    std::istringstream valid(result.out), refused(result.err);
    for (std::string line; std::getline(valid, line);) {
      EXPECT_CONTAINS(line, ": valid");
      ++answers[fileOf(line)];
      ++outcomes["valid"];
    }
    for (std::string line; std::getline(refused, line);) {
      if (!line.starts_with("error: ")) continue;  // a hint, or a warning
      line.erase(0, 7);
      ++answers[fileOf(line)];
      const std::string place = line.substr(fileOf(line).size());
      EXPECT_TRUE(place.size() > 1 && std::isdigit(static_cast<unsigned char>(place[1]))) << line;
      ++outcomes["refused"];
    }
    for (std::size_t i = 1; i < arguments.size(); ++i) EXPECT_EQ(answers[arguments[i]], 1) << arguments[i];
  }
  EXPECT_GT(outcomes["valid"], 500);
  EXPECT_GT(outcomes["refused"], 5000);
}

TEST(SceneFileMutation, MutantsRunOrSayWhyNot) {
  const SceneMutator mutator({kEveryNode});
  const TemporaryFolder folder;
  ChildOptions options;
  // GCC 12's leak sanitizer sometimes crashes at the end of a program that has unloaded plugins. Leaks are a
  // matter of the other tests.
  options.environment["ASAN_OPTIONS"] = "detect_leaks=0";
  std::map<int, int> codes;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::string scene = folder.write("mutant.json", mutator.mutate(seed));
    const ChildResult result = runWeir({"run", scene, "--frames", "1", "--device", "cpu"}, options);
    EXPECT_FALSE(result.timedOut);
    EXPECT_TRUE(result.code == 0 || (result.code >= 3 && result.code <= 5))
        << result.code << ", signal " << result.signal << ": " << result.err;
    EXPECT_TRUE(result.code == 0 || contains(result.err, "error: ")) << result.err;
    ++codes[result.code];
  }
  EXPECT_GT(codes[0], 20);
  EXPECT_GT(codes[3], 150);
}

}  // namespace
}  // namespace weir::test
