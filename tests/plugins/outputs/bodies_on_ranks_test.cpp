// Bodies that TwoProjections moves, by `weir run --ranks N`: the same files for any number of ranks.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>

#include "framework/scene/scene_file.h"
#include "tests/plugins/outputs/ranks_run.h"
#include "tests/support/child_process.h"
#include "tests/support/find_program.h"

namespace weir::test {
namespace {

/// A box that drifts from rank to rank, one that is held where three ranks have a border, one beside a wall,
/// and a paddle on an axle.
constexpr const char* kBodies = R"({
  "weir": 1,
  "world": { "dt": 0.004, "frame_rate": 50 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [-0.36, 0, -0.12], "max": [0.36, 0.15, 0.12] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [-0.36, 0, -0.12], "max": [0.36, 1, 0.12], "inverted": true } },
    "crate": { "type": "BoxMesh", "params": { "min": [-0.04, -0.04, -0.04], "max": [0.04, 0.04, 0.04] } },
    "blade": { "type": "BoxMesh", "params": { "min": [-0.06, -0.015, -0.05], "max": [0.06, 0.015, 0.05] } },
    "drifts": { "type": "RigidBody",
                "params": { "density": 500, "position": [-0.16, 0.16, 0], "rotation": [5, 10, 0], "velocity": [2.8, 0, 0] } },
    "held": { "type": "RigidBody", "params": { "density": 500, "position": [0.12, 0.07, 0.04],
                                               "fixed": "xyz", "fixed_rotation": "xyz" } },
    "beside": { "type": "RigidBody", "params": { "density": 300, "position": [-0.315, 0.14, -0.07] } },
    "paddle": { "type": "RigidBody", "params": { "density": 700, "position": [0.26, 0.15, 0] } },
    "axle": { "type": "Joint", "params": { "kind": "hinge", "anchor": [0.26, 0.15, 0], "axis": [0, 0, 1],
                                           "motor": true, "speed": 6 } },
    "contacts": { "type": "BodyContacts" },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.03, "rest_steps": 20 },
               "modules": { "solver": { "type": "TwoProjections" } } }
  },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
            "crate.surface -> drifts.mesh", "crate.surface -> held.mesh", "crate.surface -> beside.mesh",
            "blade.surface -> paddle.mesh", "water.fluid -> drifts.fluid", "water.fluid -> held.fluid",
            "water.fluid -> beside.fluid", "water.fluid -> paddle.fluid", "tank.boundary -> drifts.walls",
            "tank.boundary -> held.walls", "tank.boundary -> beside.walls", "tank.boundary -> paddle.walls",
            "drifts.body -> contacts.bodies", "held.body -> contacts.bodies", "beside.body -> contacts.bodies",
            "paddle.body -> contacts.bodies", "paddle.body -> axle.body", "axle.joint -> contacts.joints"]
})";

/// With what holds its paddle.
class BodiesOnRanks : public RanksTest {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(buildFolder() + "/lib/weir/plugins/weir_bodies.so"))
      GTEST_SKIP() << "there was no Bullet when this was built";
    scene_ = folder_.write("bodies.json", kBodies);
  }
};

TEST_F(BodiesOnRanks, AreTheSameForAnyNumber) {
  duration_ = "0.2";
  expectSameForAnyNumber({}, {"2", "3"});
  const Value statistics = parseJson(readFile(folder_ / "3/stats.json"), "stats.json");
  const Value& nodes = *statistics.find("nodes");
  const auto number = [&](const char* node, const char* name, std::size_t k) {
    return nodes.find(node)->find(name)->asArray()[k].asDouble();
  };
  EXPECT_GT(number("drifts", "position", 0), 0);  // from the first of three ranks over the border of two
  EXPECT_GT(number("held", "force", 1), 0);
  EXPECT_GT(number("beside", "force", 1), 0);
  EXPECT_NEAR(number("paddle", "position", 0), 0.26, 0.002);
}

TEST_F(BodiesOnRanks, GoOnFromACheckpointOfAnyNumberOnAnyOther) {
  device_ = {"--deterministic"};
  const Outcome whole = run("whole", {}, {"--ranks", "2", "--frames", "8"});
  ASSERT_EQ(whole.result.code, 0) << whole.result.err;
  for (const auto& [from, to] : {std::pair("1", "3"), std::pair("3", "2")}) {
    const std::string checkpoint = folder_ / (from + std::string(".h5"));
    const ChildResult begun = save(checkpoint, "world.dt=0.004", {"--ranks", from, "--deterministic"});
    ASSERT_EQ(begun.code, 0) << begun.err;
    expectSameEnd(run(std::string("to") + to, {}, {"--ranks", to, "--frames", "8", "--resume", checkpoint}),
                  whole, from + std::string(" to ") + to);
  }
}

}  // namespace
}  // namespace weir::test
