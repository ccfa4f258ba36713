// Bodies through the program: what is exported, drawn, resumed, and refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "framework/scene/scene_file.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"
#include "tests/plugins/outputs/written_run.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

/// Two boxes of one mesh fall into water and onto each other, and a third is held by a hinge with limits.
constexpr const char* kScene = R"({"weir": 1,
  "world": {"gravity": [0, -9.8, 0], "dt": 0.004, "frame_rate": 50, "duration": 0.4},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [-0.15, 0, -0.1], "max": [0.15, 0.1, 0.1]}},
    "tank": {"type": "StaticBoundary",
             "params": {"shape": "box", "inverted": true, "min": [-0.15, 0, -0.1], "max": [0.15, 2, 0.1]}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.025, "rest_steps": 10},
              "modules": {"solver": {"type": "SemiImplicitSolver", "params": {"iterations": 10}}}},
    "crate": {"type": "BoxMesh", "params": {"min": [-0.04, -0.04, -0.04], "max": [0.04, 0.04, 0.04]}},
    "low": {"type": "RigidBody", "params": {"density": 500, "position": [-0.05, 0.15, 0]}},
    "high": {"type": "RigidBody",
             "params": {"density": 500, "position": [-0.03, 0.25, 0.01], "rotation": [10, 20, 5]}},
    "rod": {"type": "BoxMesh", "params": {"min": [0.02, -0.01, -0.01], "max": [0.12, 0.01, 0.01]}},
    "arm": {"type": "RigidBody", "params": {"density": 800, "position": [0, 0.3, 0]}},
    "hinge": {"type": "Joint", "params": {"anchor": [0.02, 0.3, 0], "axis": [0, 0, 1], "limits": [-40, 10]}},
    "contacts": {"type": "BodyContacts"}},
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
            "crate.surface -> low.mesh", "crate.surface -> high.mesh", "rod.surface -> arm.mesh",
            "water.fluid -> low.fluid", "water.fluid -> high.fluid", "water.fluid -> arm.fluid",
            "tank.boundary -> low.walls", "tank.boundary -> high.walls", "tank.boundary -> arm.walls",
            "low.body -> contacts.bodies", "high.body -> contacts.bodies", "arm.body -> contacts.bodies",
            "arm.body -> hinge.body", "hinge.joint -> contacts.joints"],
  "render": {"width": 96, "height": 64, "camera": {"eye": [0.2, 0.5, 0.9], "target": [0, 0.15, 0]},
             "surfaces": [{"node": "crate", "color": [1, 0, 0]}]}})";

bool canHoldBodies() {
  return runWeir({"nodes", "BodyContacts"}).code == 0 &&
         runWeir({"info"}).out.find("bodies") != std::string::npos;
}

class BodiesOfRuns : public testing::Test {
 protected:
  void SetUp() override {
    if (!canHoldBodies()) GTEST_SKIP() << "built without Bullet";
  }
  ChildResult run(std::vector<std::string> more, const std::string& text = kScene) const {
    std::vector<std::string> all{
        "run", folder.write("scene.json", text), "--device", "cpu", "--threads", "2", "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return runWeir(all);
  }
  /// What it is told, of a scene with one part exchanged.
  std::string refusalOf(const std::string& part, const std::string& other) const {
    std::string text(kScene);
    const auto at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    const ChildResult result = run({"--frames", "20"}, text.replace(at, part.size(), other));
    EXPECT_GT(result.code, 0) << result.out;
    EXPECT_EQ(result.signal, 0);
    return result.err;
  }
  TemporaryFolder folder;
};

Vec3f vectorAt(const Value& list) {
  const auto& items = list.asArray();
  return {float(items[0].asDouble()), float(items[1].asDouble()), float(items[2].asDouble())};
}

/// Every vertex of the export is where position and rotation of the series bring that of the mesh.
TEST_F(BodiesOfRuns, SolidsAreExportedWhereTheSeriesSaysTheyAre) {
  const std::string solids = folder / "solids.vtkhdf", series = folder / "s.jsonl";
  const ChildResult result = run({"--export-solids", solids, "--series", series});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(expectReadable(solids), 21u);
  const ChildResult info = runWeir({"info", solids});
  EXPECT_CONTAINS(info.out, "solids.vtkhdf: an export of solids, whole");
  EXPECT_CONTAINS(info.out, "solids: low, high, rod");
  const VtkHdfReader reader(solids);
  const VtkHdfStep step = reader.read(20);
  ASSERT_EQ(step.positions.size(), 24u);
  std::string line = readFile(series);
  line.pop_back();
  const Value last = parseJson(line.substr(line.rfind('\n') + 1), "series");
  const char* const names[] = {"low", "high"};
  for (int k = 0; k < 2; ++k) {
    const Value& body = *last.find("nodes")->find(names[k]);
    const Vec3f center = vectorAt(*body.find("position"));
    const auto& q = body.find("rotation")->asArray();
    const Quatf turn{float(q[0].asDouble()), float(q[1].asDouble()), float(q[2].asDouble()),
                     float(q[3].asDouble())};
    Vec3f mean{};
    for (int i = 8 * k; i < 8 * k + 8; ++i) mean += step.positions[std::size_t(i)] / 8.0f;
    EXPECT_LT(length(mean - center), 1e-6) << names[k];
    // A corner of the cube, turned back, is one again.
    const Vec3f corner = rotate(conjugate(turn), step.positions[std::size_t(8 * k)] - center);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::abs(corner[axis]), 0.04, 1e-6);
  }
}

TEST_F(BodiesOfRuns, GoOnBitByBitWithContactsAndJoints) {
  const auto outputs = [&](const std::string& name) {
    return std::vector<std::string>{"--series",        folder / (name + ".jsonl"),
                                    "--export",        folder / (name + ".vtkhdf"),
                                    "--export-solids", folder / (name + "_solids.vtkhdf")};
  };
  ASSERT_EQ(run(outputs("whole")).code, 0);
  std::vector<std::string> first = outputs("parts"), second = first;
  first.insert(first.end(),
               {"--checkpoint", folder / "state.h5", "--checkpoint-every", "9", "--frames", "11"});
  second.insert(second.end(), {"--resume", folder / "state.h5"});
  ASSERT_EQ(run(first).code, 0);
  const ChildResult resumed = run(second);
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  expectSameSeries(folder / "whole.jsonl", folder / "parts.jsonl");
  expectSameExports(folder / "whole.vtkhdf", folder / "parts.vtkhdf");
  expectSameExports(folder / "whole_solids.vtkhdf", folder / "parts_solids.vtkhdf");
}

/// Both boxes of the mesh are drawn: without one of them there is less red.
TEST_F(BodiesOfRuns, AllBodiesOfAMeshAreDrawn) {
  const auto picture = [&](const std::string& name, const std::string& text) {
    const ChildResult result = run({"--frames", "1", "--images", folder / name}, text);
    EXPECT_EQ(result.code, 0) << result.err;
    return readFile(folder / (name + "/frame_00000.png"));
  };
  std::string alone(kScene);
  for (const char* part : {R"("crate.surface -> high.mesh", )", R"("water.fluid -> high.fluid", )",
                           R"("tank.boundary -> high.walls", )", R"("high.body -> contacts.bodies", )"})
    alone.erase(alone.find(part), std::string(part).size());
  const auto from = alone.find(R"("high": {)"), to = alone.find(R"("rod": {)");
  alone.erase(from, to - from);
  const std::string both = picture("both", kScene), one = picture("one", alone);
  EXPECT_NE(both, one);
}

TEST_F(BodiesOfRuns, BadInputIsToldWithPlaceAndRemedy) {
  const auto expect = [&](const std::string& part, const std::string& other,
                          std::initializer_list<const char*> told) {
    const std::string refusal = refusalOf(part, other);
    for (const char* text : told) EXPECT_CONTAINS(refusal, text);
  };
  folder.write("open.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
  expect(R"("rod": {"type": "BoxMesh", "params": {"min": [0.02, -0.01, -0.01], "max": [0.12, 0.01, 0.01]}})",
         R"("rod": {"type": "MeshFile", "params": {"file": "open.obj"}})",
         {"arm", "the mesh of 3 triangles from 'rod' has 3 open edges", "a closed mesh"});
  expect(R"("density": 800)", R"("mass": 0)", {"scene.json", "mass", "above 0"});
  expect(R"("density": 800)", R"("density": 1e999)", {"scene.json"});
  expect(R"("position": [-0.03, 0.25, 0.01])", R"("position": [-0.03, 0.19, 0.01])",
         {"contacts", "'low' starts", "m deep within 'high'", "bodies that start apart"});
  expect(R"("position": [-0.03, 0.25, 0.01])", R"("position": [-0.03, 0.25, 0.5])",
         {"high", "m deep within its walls", "a position"});
  expect(R"("arm.body -> hinge.body", )", "", {"hinge", "body"});
  expect(R"("arm.body -> contacts.bodies",)", "",
         {"the joint 'hinge' holds 'arm', which is not among the bodies", "arm.body -> contacts.bodies"});
  expect(R"("arm.body -> hinge.body", "hinge.joint -> contacts.joints")",
         R"("arm.body -> hinge.body", "arm.body -> hinge.other", "hinge.joint -> contacts.joints")",
         {"hinge", "both ends are the same body"});
  expect(
      R"("params": {"spacing": 0.025, "rest_steps": 10})",
      R"("params": {"spacing": 0.025, "rest_steps": 10, "domain_min": [-1, 0.5, -1], "domain_max": [1, 2, 1]})",
      {"the body starts outside the domain of 'water'", "a position within"});
  expect(R"("limits": [-40, 10])", R"("limits": [5, 10])", {"hinge", "found limits of 5 and 10", "limits"});
}

}  // namespace
}  // namespace weir::test
