// Scenes that give SemiImplicitSolver what AcceleratedSolver has now, and a strength to Xsph without its
// form.
#include <gtest/gtest.h>

#include <atomic>

#include "nodes/particle_fluid/particle_fluid.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

std::string sceneWith(const std::string& solver) {
  return R"({"weir": 1, "world": {"dt": 0.01, "frame_rate": 50, "duration": 0.06},
    "nodes": {
      "block": {"type": "BoxSampler", "params": {"min": [0, 0.1, 0], "max": [0.2, 0.3, 0.2]}},
      "tank": {"type": "StaticBoundary",
               "params": {"shape": "box", "min": [0, 0, 0], "max": [0.5, 0.5, 0.2], "inverted": true}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.025, "rest_steps": 0},
                "modules": {"solver": )" +
         solver + R"(}}},
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"]})";
}

struct Built {
  std::vector<std::string> warnings;
  std::string type;
  Value params;
};

Built built(const std::string& solver, const std::vector<std::string>& overrides = {},
            const char* name = "solver") {
  Registry registry;
  registerNodes(registry);
  std::vector<Override> changes;
  for (const std::string& change : overrides) changes.push_back(parseOverride(change));
  Built result;
  const auto scene = buildScene(parseJson(sceneWith(solver), "s.json"), {"s.json", "", "/"}, registry,
                                changes, result.warnings);
  const Module& module = *scene->graph.find("water")->pipeline()->find(name);
  result.type = module.info().type;
  result.params = module.changedValues();
  return result;
}

std::vector<Vec3f> endOf(const std::string& solver) {
  CpuDevice device(2);
  SimulatedScene scene(device, sceneWith(solver));
  scene->reset();
  const std::atomic<bool> never = false;
  while (scene->advanceFrame(never)) continue;
  ParticleSet& particles = scene.node<ParticleFluid>("water").fluid->set();
  return particles.positions().toHost(particles.bound());
}

TEST(MovedParameters, AnOldSceneGetsTheOtherSolverAndAWarningThatSaysWhatToWrite) {
  const Built old = built(R"({"params": {"iterations": 40, "tolerance": 0.01, "acceleration": "nesterov"}})");
  EXPECT_EQ(old.type, "AcceleratedSolver");
  ASSERT_EQ(old.warnings.size(), 1u);
  EXPECT_CONTAINS(old.warnings[0], "'tolerance' or 'acceleration'");
  EXPECT_CONTAINS(old.warnings[0], "s.json:");
  EXPECT_CONTAINS(old.warnings[0], "/nodes/water/modules/solver/params");
  // What it says to write builds the same solver and warns no more.
  const std::string::size_type begin = old.warnings[0].find("{ \"solver\"");
  ASSERT_NE(begin, std::string::npos) << old.warnings[0];
  const std::string text = old.warnings[0].substr(begin, old.warnings[0].rfind('}') + 1 - begin);
  const Built now = built(writeJson(*parseJson(text, "warning").find("solver")));
  EXPECT_TRUE(now.warnings.empty());
  EXPECT_EQ(now.type, old.type);
  EXPECT_EQ(now.params, old.params);
}

TEST(MovedParameters, WhatAnOldSceneLeavesOutIsWhatItWas) {
  const Built old = built(R"({"type": "SemiImplicitSolver", "params": {"acceleration": "nesterov"}})");
  EXPECT_EQ(old.type, "AcceleratedSolver");
  EXPECT_EQ(*old.params.find("max_iterations"), Value(3));
  EXPECT_TRUE(old.params.find("tolerance")->isNull());
  EXPECT_EQ(
      *built(R"({"type": "SemiImplicitSolver", "params": {"tolerance": 0.1}})").params.find("acceleration"),
      Value("none"));
}

TEST(MovedParameters, OverridesAreReadAlike) {
  const Built old = built("{}", {"water.solver.tolerance=0.01", "water.solver.iterations=7"});
  EXPECT_EQ(old.type, "AcceleratedSolver");
  EXPECT_EQ(old.warnings.size(), 1u);
  EXPECT_EQ(*old.params.find("max_iterations"), Value(7));
}

TEST(MovedParameters, WhatDidNothingIsLeftOutAndThePapersSolverStays) {
  for (const char* params : {R"("neighbor_searches": 1)", R"("path_stages": 4)", R"("tolerance": null)",
                             R"("acceleration": "none")"}) {
    const Built old = built(std::string(R"({"params": {"iterations": 5, )") + params + "}}");
    EXPECT_EQ(old.type, "SemiImplicitSolver") << params;
    ASSERT_EQ(old.warnings.size(), 1u) << params;
    EXPECT_CONTAINS(old.warnings[0], "no effect here");
    EXPECT_CONTAINS(old.warnings[0], "hint: leave it out");
    EXPECT_EQ(*old.params.find("iterations"), Value(5));
  }
}

TEST(MovedParameters, WhatDidNothingIsCheckedAllTheSame) {
  const Error error =
      errorOf([] { built(R"({"type": "SemiImplicitSolver", "params": {"path_stages": 0}})"); });
  EXPECT_CONTAINS(std::string(error.what()), "path_stages");
  EXPECT_CONTAINS(std::string(error.what()), "an integer of at least 1 and at most 100");
}

TEST(MovedParameters, ASceneWithTheNamesOfBothIsNotGuessedAt) {
  EXPECT_EQ(*built(R"({"params": {"tolerance": 0.01, "max_iterations": 50}})").params.find("max_iterations"),
            Value(50));
  const Error error =
      errorOf([] { built(R"({"params": {"tolerance": 0.01, "max_iterations": 50, "iterations": 4}})"); });
  EXPECT_CONTAINS(std::string(error.what()), "no parameter 'iterations'");
}

TEST(MovedParameters, OtherScenesAreLeftAlone) {
  for (const char* solver : {R"({"params": {"iterations": 5}})", R"({"type": "Pbf"})",
                             R"({"type": "AcceleratedSolver", "params": {"tolerance": 0.01}})"})
    EXPECT_TRUE(built(solver).warnings.empty()) << solver;
  EXPECT_EQ(built(R"({"params": {"iterations": 5}})").type, "SemiImplicitSolver");
}

TEST(MovedParameters, ASolverWithoutATypeIsTheOneThatKnowsItsParameters) {
  EXPECT_EQ(built("{}").type, "AcceleratedSolver");
  EXPECT_EQ(built(R"({"params": {"tolerance": 0.01}})").type, "AcceleratedSolver");
  EXPECT_EQ(built(R"({"params": {"conservative": false}})").type, "AcceleratedSolver");
  EXPECT_EQ(built("{}", {"water.solver.iterations=5"}).type, "SemiImplicitSolver");
  const Error error = errorOf([] { built(R"({"type": "AcceleratedSolver", "params": {"iterations": 5}})"); });
  EXPECT_CONTAINS(std::string(error.what()), "no parameter 'iterations'");
}

TEST(MovedParameters, IterationsAloneEndInTheBitsOfTheSolverThatIsNamed) {
  EXPECT_EQ(endOf(R"({"params": {"iterations": 5}})"),
            endOf(R"({"type": "SemiImplicitSolver", "params": {"iterations": 5}})"));
}

TEST(MovedParameters, BothWordingsEndInTheSameBits) {
  EXPECT_EQ(endOf(R"({"params": {"tolerance": 0.01, "iterations": 50, "acceleration": "nesterov"}})"),
            endOf(R"({"type": "AcceleratedSolver",
                      "params": {"tolerance": 0.01, "max_iterations": 50, "acceleration": "nesterov"}})"));
}

TEST(MovedParameters, AStrengthOfXsphWithoutAFormCountsInSteps) {
  const Built old = built("{}", {"water.viscosity.strength=0.1"}, "viscosity");
  EXPECT_EQ(*old.params.find("form"), Value("explicit"));
  EXPECT_EQ(old.params.find("strength")->brief(), "0.1");
  ASSERT_EQ(old.warnings.size(), 1u);
  EXPECT_CONTAINS(old.warnings[0], "counts in each step");
  EXPECT_CONTAINS(old.warnings[0], R"("form": "explicit")");
  for (const std::vector<std::string>& now :
       {std::vector<std::string>{"water.viscosity.strength=0.1", "water.viscosity.form=explicit"},
        {"water.viscosity.rate=100"},
        {"water.viscosity.form=implicit"}})
    EXPECT_TRUE(built("{}", now, "viscosity").warnings.empty()) << now.front();
}

}  // namespace
}  // namespace weir::test
