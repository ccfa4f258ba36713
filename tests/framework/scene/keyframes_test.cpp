// Parameters that are given by keyframes: values over time, errors, writing, --set, schema, and who updates
// them.
#include "framework/graph/keyframes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "framework/base/turn.h"
#include "framework/run/simulation.h"
#include "framework/scene/scene_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_nodes.h"

namespace weir {
namespace {

using test::errorOf;

class Turn : public Module {
 public:
  static constexpr std::string_view kFamily = "Turn";
  static constexpr ModuleInfo kInfo{"Turn", kFamily, "A module with an amount."};
  const ModuleInfo& info() const override { return kInfo; }
  Param<float> amount{*this, "amount", 1, {.animated = true, .doc = "An amount."}};
};

struct Key : Configurable {
  Param<double> level{*this, "level", 0, {.animated = true, .doc = "A level."}};
};

/// Records what its parameters were in each step.
class Moving final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Moving", "Has parameters that move."};
  const NodeInfo& info() const override { return kInfo; }
  Param<float> speed{*this, "speed", 1, {.unit = "m/s", .min = 0, .max = 10, .animated = true, .doc = "A."}};
  Param<double> height{*this, "height", 2, {.min = 0, .aboveMin = true, .animated = true, .doc = "B."}};
  Param<Vec3f> position{*this, "position", {}, {.unit = "m", .animated = true, .doc = "C."}};
  Param<Rotation> rotation{*this, "rotation", {}, {.animated = true, .doc = "D."}};
  Param<float> fixed{*this, "fixed", 1, {.doc = "E."}};
  Param<int> count{*this, "count", 1, {.doc = "F."}};
  Group<Key> key{*this, "key", "A group."};
  GroupList<Key> keys{*this, "keys", "A list."};

  Moving() {
    pipeline_.add<Turn>("turn");
    pipeline_.markDefault();
  }
  PipelineBase* pipeline() override { return &pipeline_; }
  Turn& turn() { return static_cast<Turn&>(*pipeline_.find("turn")); }

  struct Record {
    double time, gravity, speed, amount;
  };
  void reset(const SetupContext& context) override { atReset = {0, context.gravity.y, speed, turn().amount}; }
  void step(const StepContext& c) override { steps.push_back({c.time, c.gravity.y, speed, turn().amount}); }
  void frame(const StepContext& c) override { frames.push_back({c.time, c.gravity.y, speed, turn().amount}); }
  Record atReset{};
  std::vector<Record> steps, frames;

 private:
  Pipeline<Turn> pipeline_;
};

class KeyframesTest : public testing::Test {
 protected:
  KeyframesTest() { registry.addNode<Moving>(), registry.addModule<Turn>(); }

  std::unique_ptr<Scene> build(const std::string& params, const std::vector<std::string>& settings = {},
                               const std::string& rest = "") {
    const std::string text = R"({"weir": 1, "nodes": {"m": {"type": "Moving",
"params": )" + params + "}}" +
                             rest + "}";
    std::vector<Override> overrides;
    for (const std::string& setting : settings) overrides.push_back(parseOverride(setting));
    std::vector<std::string> warnings;
    return buildScene(parseJson(text, "s.json"), {"s.json", "", "/"}, registry, overrides, warnings);
  }
  Moving& moving(const std::unique_ptr<Scene>& scene) {
    return static_cast<Moving&>(*scene->graph.find("m"));
  }
  std::string errorText(const std::string& params) {
    return errorOf([&] { build(params); }).what();
  }

  Registry registry;
};

TEST_F(KeyframesTest, AreLinearBetweenAndHeldAtTheEnds) {
  const auto scene = build(R"({"speed": {"keyframes": [[1, 2], [2, 6], [4, 5]]},
    "position": {"keyframes": [[0, [0, 1, 2]], [2, [4, 1, -2]]]},
    "rotation": {"keyframes": [[0, [0, 0, 0]], [1, [0, 720, 0]]]},
    "height": {"keyframes": [[3, 0.1]]}})");
  Moving& m = moving(scene);
  EXPECT_EQ(m.speed, 2);  // until someone asks for another time, that of time 0
  for (const auto& [time, speed] :
       {std::pair{0.0, 2.0}, {1.0, 2.0}, {1.25, 3.0}, {2.0, 6.0}, {3.0, 5.5}, {4.0, 5.0}, {100.0, 5.0}}) {
    m.animate(time);
    EXPECT_FLOAT_EQ(m.speed, float(speed)) << time;
    EXPECT_EQ(m.height, 0.1);
  }
  m.animate(0.5);
  EXPECT_EQ(m.position.get(), (Vec3f{1, 1, 1}));
  EXPECT_EQ(m.rotation->degrees, (Vec3f{0, 360, 0}));
}

TEST_F(KeyframesTest, OfQuaternionsAreTheShortestTurn) {
  // About one axis, an angle: of q and −q, and where the other one is given by angles.
  const auto scene = build(R"({"rotation": {"keyframes": [[0, [1, 0, 0, 0]], [1, [0.8, 0, 0.6, 0]],
    [2, [-0.6, 0, -0.8, 0]], [3, [0, 90, 0]]]}})");
  Moving& m = moving(scene);
  const double angles[] = {0, 2 * std::acos(0.8), 2 * std::acos(0.6), std::numbers::pi / 2};
  for (double time = 0; time < 3; time += 0.125) {
    m.animate(time);
    const auto k = static_cast<std::size_t>(time);
    const double angle = angles[k] + (time - double(k)) * (angles[k + 1] - angles[k]);
    const Quatf q = m.rotation->toQuaternion();
    const float sign = q.w < 0 ? -1.0f : 1.0f;  // which turn alike
    EXPECT_NEAR(sign * q.w, std::cos(angle / 2), 1e-6) << time;
    EXPECT_NEAR(sign * q.y, std::sin(angle / 2), 1e-6) << time;
    EXPECT_NEAR(std::hypot(q.x, q.z), 0, 1e-6) << time;
  }
  const auto rate = [](const Rotation& a, const Rotation& b) {
    return shortestAngle(a.toQuaternion(), b.toQuaternion());
  };
  EXPECT_NEAR(m.rotation.fastest(0, 1, rate), angles[1], 1e-6);
  EXPECT_NEAR(m.rotation.fastest(2.5, 3, rate), std::abs(angles[3] - angles[2]), 1e-6);
}

TEST_F(KeyframesTest, TheMeanIsExact) {
  const auto scene = build(R"({"speed": {"keyframes": [[1, 2], [2, 6], [4, 5]]}})");
  const Param<float>& speed = moving(scene).speed;
  for (const auto& [from, to] :
       {std::pair{0.0, 0.5}, {0.0, 5.0}, {1.3, 1.4}, {1.5, 3.5}, {1.0, 2.0}, {4.5, 7.0}}) {
    // The midpoint rule with a step that divides all of these is exact on each linear piece.
    double sum = 0;
    const int n = static_cast<int>(std::round((to - from) / 0.01));
    for (int k = 0; k < n; ++k) {
      moving(scene).animate(from + (k + 0.5) * 0.01);
      sum += double(speed.get()) / n;
    }
    EXPECT_NEAR(speed.mean(from, to), sum, 1e-6) << from << " " << to;
  }
  EXPECT_EQ(moving(scene).height.mean(1, 3), 2);  // a plain value
}

TEST_F(KeyframesTest, ErrorsNameThePlace) {
  const auto expect = [&](const std::string& params, const std::string& place, const std::string& what) {
    const std::string text = errorText(params);
    EXPECT_CONTAINS(text, "/nodes/m/params" + place);
    EXPECT_CONTAINS(text, what);
    EXPECT_CONTAINS(text, "s.json:2:");
  };
  expect(R"({"speed": {"keyframes": [[1, 2], [1, 6]]}})", "/speed/keyframes/1/0", "times that increase");
  expect(R"({"speed": {"keyframes": [[1, 2], [0.5, 6]]}})", "/speed/keyframes/1/0", "0.5 s after one of 1 s");
  expect(R"({"speed": {"keyframes": [[-1, 2]]}})", "/speed/keyframes/0/0", "of at least 0");
  expect(R"({"speed": {"keyframes": [["now", 2]]}})", "/speed/keyframes/0/0", "a number");
  expect(R"({"speed": {"keyframes": [[0, 2], [1, 11]]}})", "/speed/keyframes/1/1", "at most 10");
  expect(R"({"height": {"keyframes": [[0, 2], [1, 0]]}})", "/height/keyframes/1/1", "above 0");
  expect(R"({"position": {"keyframes": [[0, [1, 2]]]}})", "/position/keyframes/0/1", "three numbers");
  expect(R"({"rotation": {"keyframes": [[0, [1, 1, 0, 0]]]}})", "/rotation/keyframes/0/1", "length 1.414");
  expect(R"({"speed": {"keyframes": []}})", "/speed/keyframes", "at least one");
  expect(R"({"speed": {"keyframes": 3}})", "/speed/keyframes", "found 3");
  expect(R"({"speed": {"keyframes": [3]}})", "/speed/keyframes/0", "[time, value]");
  expect(R"({"speed": {"keyframes": [[0, 1, 2]]}})", "/speed/keyframes/0", "[time, value]");
  expect(R"({"speed": {"keyframes": [[0, 1]], "loop": true}})", "/speed/loop", "no member 'loop'");
  expect(R"({"speed": {"frames": [[0, 1]]}})", "/speed", "a number");
  expect(R"({"fixed": {"keyframes": [[0, 1]]}})", "/fixed", "cannot change over time");
  expect(R"({"count": {"keyframes": [[0, 1]]}})", "/count", "cannot change over time");
  expect(R"({"keys": [{}, {"level": {"keyframes": [[0, "a"]]}}]})", "/keys/1/level/keyframes/0/1",
         "a number");
}

TEST_F(KeyframesTest, ARefusedValueLeavesTheKeyframes) {
  const auto scene = build(R"({"speed": {"keyframes": [[0, 2], [2, 6]]}})");
  Moving& m = moving(scene);
  const Value before = m.changedValues();
  Value bad = Value::object();
  bad["speed"] = 3;
  bad["count"] = "x";
  EXPECT_THROW(m.assignAll(bad, {}), Error);
  EXPECT_EQ(m.changedValues(), before);
  m.animate(1);
  EXPECT_EQ(m.speed, 4);
  m.speed.set(3);
  m.animate(1);
  EXPECT_EQ(m.speed, 3);  // a plain value again
}

constexpr const char* kAll = R"({"speed": {"keyframes": [[0, 0.1], [2, 3]]},
  "position": {"keyframes": [[0.5, [0, 1, 2]], [2, [4, 1, -2]]]},
  "rotation": {"keyframes": [[0, [0, 0, 0]], [1, [0, 720, 0]]]},
  "key": {"level": {"keyframes": [[0, 1], [1, 2]]}}, "keys": [{"level": {"keyframes": [[0, 5]]}}, {}]})";

TEST_F(KeyframesTest, WritingBackGivesTheSameScene) {
  const auto scene =
      build(kAll, {}, R"(, "world": {"gravity": {"keyframes": [[0, [0, -9, 0]], [1, [0, 9, 0]]]}})");
  const Value once = sceneToValue(*scene);
  EXPECT_EQ(*once.find("nodes")->find("m")->find("params"), parseJson(kAll, "all"));
  scene->animate(0.7);
  scene->graph.nodes().front()->animate(0.7);
  EXPECT_EQ(sceneToValue(*scene), once);  // whatever the time
  std::vector<std::string> warnings;
  const auto again = buildScene(parseJson(writeJson(once), "t"), {"t", "", "/"}, registry, {}, warnings);
  EXPECT_EQ(sceneToValue(*again), once);
}

TEST_F(KeyframesTest, TheCommandLineSetsThem) {
  const auto scene =
      build(R"({"speed": 1, "height": {"keyframes": [[0, 1], [2, 3]]}})",
            {"m.speed={\"keyframes\": [[0, 0], [1, 4]]}", "m.height.keyframes.1.1=5",
             "m.position.keyframes=[[0, [1, 2, 3]]]", "m.turn.amount.keyframes=[[0, 1], [1, 2]]"});
  Moving& m = moving(scene);
  m.animate(1);
  m.turn().animate(1);
  EXPECT_EQ(m.speed, 4);
  EXPECT_EQ(m.height, 3);
  EXPECT_EQ(m.position.get(), (Vec3f{1, 2, 3}));
  EXPECT_EQ(m.turn().amount, 2);
  const auto plain = build(R"({"speed": {"keyframes": [[0, 1], [2, 3]]}})", {"m.speed=7"});
  moving(plain).animate(1);
  EXPECT_EQ(moving(plain).speed, 7);
  EXPECT_CONTAINS(errorOf([&] { build("{}", {"m.speed={\"keyframes\": [[1, 0], [0, 4]]}"}); }).what(),
                  "times that increase");
}

TEST_F(KeyframesTest, ASimulationUpdatesThemBeforeEachStep) {
  auto scene = build(R"({"speed": {"keyframes": [[0, 0], [1, 10]]}}, "modules": {"turn": {"params":
      {"amount": {"keyframes": [[0, 1], [1, 2]]}}}})",
                     {}, R"(, "world": {"dt": 0.05, "frame_rate": 10, "duration": 0.5,
      "gravity": {"keyframes": [[0, [0, -10, 0]], [0.2, [0, 10, 0]]]}})");
  const auto device = openDevice("cpu");
  const Log log;
  Simulation simulation(std::move(scene), *device, const_cast<Log&>(log), registry);
  Moving& m = static_cast<Moving&>(*simulation.scene().graph.find("m"));
  const std::atomic<bool> stop = false;
  for (int round = 0; round < 2; ++round) {  // a reset starts the time again
    m.steps.clear(), m.frames.clear();
    simulation.reset();
    EXPECT_EQ(m.atReset.gravity, -10);
    EXPECT_EQ(m.atReset.speed, 0);
    EXPECT_EQ(m.atReset.amount, 1);
    while (simulation.advanceFrame(stop)) {
    }
    ASSERT_EQ(m.steps.size(), 10u);
    ASSERT_EQ(m.frames.size(), 6u);
    for (const auto& records : {m.steps, m.frames})
      for (const Moving::Record& r : records) {
        EXPECT_NEAR(r.speed, 10 * r.time, 1e-5);
        EXPECT_NEAR(r.amount, 1 + r.time, 1e-6);
        EXPECT_NEAR(r.gravity, std::min(10.0, -10 + 100 * r.time), 1e-5);
      }
    EXPECT_NEAR(m.frames.back().time, 0.5, 1e-12);
  }
}

TEST_F(KeyframesTest, OnlyWhatCanMoveMayBeDeclaredAnimated) {
  struct Wrong : Configurable {
    Param<bool> flag{*this, "flag", false, {.animated = true}};
  };
  EXPECT_THROW(Wrong(), InternalError);
}

#ifdef WEIR_TEST_PYTHON
TEST_F(KeyframesTest, TheSchemaDescribesThem) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "weir_keyframes_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "schema.json") << writeJson(sceneSchema(registry));
  const auto write = [&](const std::string& name, const std::string& params) {
    std::ofstream(folder / name) << R"({"weir": 1, "nodes": {"m": {"type": "Moving", "params": )" << params
                                 << "}}}";
  };
  write("good1.json", kAll);
  write("good2.json", R"({"speed": 3})");
  write("bad1.json", R"({"fixed": {"keyframes": [[0, 1]]}})");
  write("bad2.json", R"({"speed": {"keyframes": [[0, 11]]}})");
  write("bad3.json", R"({"speed": {"keyframes": []}})");
  write("bad4.json", R"({"speed": {"keyframes": [[0]]}})");
  write("bad5.json", R"({"speed": {"keyframes": [[0, 1]], "loop": 1}})");
  const std::string command = std::string(WEIR_TEST_PYTHON) + " \"" + WEIR_SOURCE_FOLDER +
                              "/tests/framework/scene/check_schema.py\" \"" + folder.string() + "\"";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::filesystem::remove_all(folder);
}
#endif

}  // namespace
}  // namespace weir
