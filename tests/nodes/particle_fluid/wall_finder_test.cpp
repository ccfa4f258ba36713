// The fluid and its solver ask the module that has the role for what the fluid feels of solids, whatever its
// class is.
#include <gtest/gtest.h>

#include <atomic>

#include "framework/run/simulation.h"
#include "framework/scene/scene_file.h"
#include "nodes/particle_fluid/modules/wall_integrals.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/register_nodes.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

/// The usual integrals, by another class.
class CountingWalls final : public FluidModule, public WallFinder {
 public:
  static constexpr ModuleInfo kInfo{"CountingWalls", kFamily, "Counts how often it is asked."};
  const ModuleInfo& info() const override { return kInfo; }
  void step(FluidStep& fluid) override { findWalls(fluid); }
  void findWalls(FluidStep& fluid) override {
    ++asked;
    usual_.findWalls(fluid);
  }
  int asked = 0;

 private:
  WallIntegrals usual_;
};

/// Water in a box of triangles; WALLS stands for the module "walls".
constexpr const char* kScene = R"({"weir": 1,
  "world": {"dt": 0.005, "frame_rate": 50, "duration": 0.04},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.12, 0.12, 0.12]}},
    "room": {"type": "BoxMesh", "params": {"min": [0, 0, 0], "max": [0.2, 0.2, 0.12]}},
    "tank": {"type": "SemiAnalyticalSFI", "params": {"fill": "container"}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 0},
              "modules": {"walls": WALLS, "solver": {"type": "SemiImplicitSolver", "params": {"tolerance": 0.01, "path_stages": 2}}}}},
  "links": ["block.particles -> water.initial", "room.surface -> tank.solids", "water.fluid -> tank.fluid"]})";

class WallFinderRole : public testing::Test {
 protected:
  WallFinderRole() {
    registerNodes(registry_);
    registry_.addModule<CountingWalls>();
  }
  ParticleFluid& run(const std::string& walls) {
    std::string text = kScene;
    text.replace(text.find("WALLS"), 5, walls);
    std::vector<std::string> warnings;
    auto scene = buildScene(parseJson(text, "test"), {"test", "", "."}, registry_, {}, warnings);
    simulation_ = std::make_unique<Simulation>(std::move(scene), *device_, log_, registry_);
    simulation_->reset();
    const std::atomic<bool> never = false;
    while (simulation_->advanceFrame(never)) {
    }
    return dynamic_cast<ParticleFluid&>(*simulation_->scene().graph.find("water"));
  }

 private:
  std::unique_ptr<Device> device_ = openDevice("cpu", 2);
  Log log_{[](LogLevel, std::string_view) {}};
  Registry registry_;
  std::unique_ptr<Simulation> simulation_;
};

TEST_F(WallFinderRole, AnotherClassThatHasItGivesTheSameRun) {
  ParticleFluid& usual = run("{}");
  const std::vector<Vec3f> positions = usual.fluid->set().positions().toHost(usual.particleCount());
  ParticleFluid& counted = run(R"({"type": "CountingWalls"})");
  EXPECT_EQ(counted.fluid->set().positions().toHost(counted.particleCount()), positions);
  // 8 steps and 3 frames; the solver asks once more wherever it searches anew.
  EXPECT_GE(dynamic_cast<CountingWalls&>(*counted.pipeline()->find("walls")).asked, 11);
}

TEST_F(WallFinderRole, AFluidThatMeetsSolidsNeedsAModuleThatHasIt) {
  const Error error = errorOf([&] { run(R"({"enabled": false})"); });
  EXPECT_CONTAINS(error.what(), "water");
  EXPECT_CONTAINS(error.message(), "no enabled module of it finds what it feels of them");
}

}  // namespace
}  // namespace weir::test
