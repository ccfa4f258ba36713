#include "tests/plugins/outputs/written_run.h"

#include <algorithm>
#include <sstream>
#include <type_traits>

#include "framework/scene/scene_file.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"
#include "tests/plugins/video/video_tools.h"

namespace weir::test {

const char* const kStateful = R"({"weir": 1,
  "world": {"dt": 0.01, "cfl": 0.4, "frame_rate": 50, "duration": 0.4, "seed": 3},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.3, 0.1, 0.3], "jitter": 0.1}},
    "nozzle": {"type": "CircleEmitter",
               "params": {"position": [0.1, 0.3, 0.1], "radius": 0.05, "jitter": 0.2, "arrangement": "lattice",
                          "speed": {"keyframes": [[0, 0.5], [0.4, 1.5]]}}},
    "drain": {"type": "Sink", "params": {"min": [0.25, -1, 0.25], "max": [0.4, 0.02, 0.4]}},
    "room": {"type": "BoxMesh", "params": {"min": [0, 0, 0], "max": [0.3, 0.5, 0.3]}},
    "walls": {"type": "SemiAnalyticalSFI", "params": {"fill": "container"}},
    "blade": {"type": "BoxMesh", "params": {"min": [0.1, 0.02, 0.14], "max": [0.2, 0.12, 0.16]}},
    "stirrer": {"type": "SemiAnalyticalSFI",
                "params": {"angular_velocity": [0, 6, 0], "pivot": [0.15, 0, 0.15]}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 5},
              "modules": {"solver": {"type": "AcceleratedSolver",
                                     "params": {"tolerance": 0.02, "max_iterations": 3, "acceleration": "nesterov"}}}}},
  "links": ["block.particles -> water.initial", "nozzle.particles -> water.emitters", "drain.sink -> water.sinks",
            "room.surface -> walls.solids", "water.fluid -> walls.fluid",
            "blade.surface -> stirrer.solids", "water.fluid -> stirrer.fluid"],
  "render": {"width": 96, "height": 64}})";

bool canMakeVideos() {
  return !findProgram("ffmpeg").empty() && !findProgram("ffprobe").empty();
}

namespace {

/// Without the times.
std::vector<Value> seriesIn(const std::string& file) {
  std::vector<Value> frames;
  std::istringstream lines(readFile(file));
  for (std::string line; std::getline(lines, line);) {
    Value frame = parseJson(line, file);
    frame["stepping_seconds"] = 0;
    frames.push_back(std::move(frame));
  }
  return frames;
}

void expectSameValues(const std::string& path, const Value& one, const Value& other) {
  if (!one.isObject() || !other.isObject()) {
    EXPECT_TRUE(one == other) << path << ": " << writeJson(one) << " and " << writeJson(other);
    return;
  }
  EXPECT_EQ(one.asObject().size(), other.asObject().size()) << path;
  for (const auto& [name, value] : one.asObject()) {
    const Value* found = other.find(name);
    EXPECT_NE(found, nullptr) << path << "." << name;
    if (found != nullptr) expectSameValues(path + "." + name, value, *found);
  }
}

}  // namespace

void expectSameSeries(const std::string& one, const std::string& other) {
  const std::vector<Value> left = seriesIn(one), right = seriesIn(other);
  ASSERT_EQ(left.size(), right.size());
  for (std::size_t k = 0; k < left.size(); ++k)
    expectSameValues("frame " + std::to_string(k), left[k], right[k]);
}

namespace {

/// NaN, which stands where particles have no value, is the same as NaN.
bool areSame(const VtkHdfArray& one, const VtkHdfArray& other) {
  if (one.values.index() != other.values.index()) return false;
  const auto same = [](auto a, auto b) { return a == b || (a != a && b != b); };
  return std::visit(
      [&](const auto& values) {
        return std::ranges::equal(values, std::get<std::decay_t<decltype(values)>>(other.values), same);
      },
      one.values);
}

}  // namespace

void expectSameExports(const std::string& one, const std::string& other) {
  const VtkHdfReader a(one), b(other);
  ASSERT_EQ(a.times(), b.times());
  for (std::size_t k = 0; k < a.times().size(); ++k) {
    const VtkHdfStep left = a.read(k), right = b.read(k);
    EXPECT_TRUE(left.positions == right.positions) << "frame " << k;
    ASSERT_EQ(left.arrays.size(), right.arrays.size());
    for (std::size_t i = 0; i < left.arrays.size(); ++i) {
      EXPECT_EQ(left.arrays[i].name, right.arrays[i].name);
      EXPECT_TRUE(areSame(left.arrays[i], right.arrays[i])) << left.arrays[i].name << " at frame " << k;
    }
  }
}

std::size_t expectReadable(const std::string& file) {
  const VtkHdfReader reader(file);
  const std::size_t steps = reader.times().size();
  for (std::size_t k = 0; k < steps; ++k) EXPECT_NO_THROW(reader.read(k)) << "step " << k << " of " << file;
  // The first one, which has the oldest VTK: read_with_vtk.py has all of them read a file.
  std::istringstream pythons(WEIR_TEST_PYTHONS);
  if (std::string python; std::getline(pythons, python, ':')) {
    const ChildResult result = runChild(python, {"-B", WEIR_READ_STEPS, file, std::to_string(steps)});
    EXPECT_EQ(result.code, 0) << result.out << result.err;
  }
  return steps;
}

}  // namespace weir::test
