// Particles of a node that is not a fluid, here the tracers of examples/plugins, are exported, drawn, shown
// in replays and given a surface as those of a fluid are.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "framework/scene/scene_file.h"
#include "nodes/particle_file/ply_reader.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"
#include "plugins/vtkhdf/vtkhdf_writer.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

constexpr const char* kScene = R"({"weir": 1,
  "world": {"dt": 0.01, "frame_rate": 10, "duration": 0.3},
  "nodes": {
    "strip": {"type": "BoxSampler", "params": {"min": [-0.5, 0, -0.1], "max": [0.5, 0.1, 0.1]}},
    "vortex": {"type": "VortexTracers", "params": {"spacing": 0.05, "circulation": 0.6}}},
  "links": ["strip.particles -> vortex.initial"],
  "render": {"width": 96, "height": 64, "camera": {"eye": [0, 1.5, 0.9], "target": [0, 0, 0]},
             "color": {"by": "revolutions"}}})";
constexpr std::size_t kTracers = 160;

class ParticlesWithoutAFluid : public testing::Test {
 protected:
  ChildResult run(const std::string& scene, std::vector<std::string> more) const {
    std::vector<std::string> all{"run", folder.write("scene.json", scene), "--device", "cpu", "--threads",
                                 "2"};
    return withPlugin(all, more);
  }
  ChildResult withPlugin(std::vector<std::string> all, const std::vector<std::string>& more) const {
    all.insert(all.end(), more.begin(), more.end());
    all.insert(all.end(), {"--plugin", buildFolder() + "/lib/weir/test_plugins/weir_tracers.so"});
    return runWeir(all);
  }
  /// The scene with another node and link.
  static std::string with(const std::string& node, const std::string& links) {
    std::string scene = kScene;
    scene.replace(scene.find("\"vortex\": {"), 0, node + ", ");
    scene.replace(scene.find("\"strip.particles ->"), 0, links + ", ");
    return scene;
  }
  std::string picture(const std::string& images, int frame) const {
    return readFile(folder / images + "/frame_0000" + std::to_string(frame) + ".png");
  }

  TemporaryFolder folder;
};

TEST_F(ParticlesWithoutAFluid, StandInExportsWithTheirAttributes) {
  const std::string file = folder / "run.vtkhdf", stats = folder / "stats.json";
  const ChildResult result =
      run(kScene, {"--export", file, "--ply-particles", folder / "points", "--stats", stats});
  ASSERT_EQ(result.code, 0) << result.err;
  const VtkHdfReader reader(file);
  const VtkHdfStep first = reader.read(0), last = reader.readLast();
  ASSERT_EQ(first.positions.size(), kTracers);
  ASSERT_EQ(last.positions.size(), kTracers);
  ASSERT_NE(last.find("revolutions"), nullptr);
  const auto& revolutions = std::get<std::vector<float>>(last.find("revolutions")->values);
  const ParticleData points = PlyReader().read(folder / "points/vortex_00003.ply");
  ASSERT_EQ(points.positions.size(), kTracers);
  for (std::size_t i = 0; i < kTracers; ++i) {
    const Vec3f &from = first.positions[i], &to = last.positions[i];
    EXPECT_NEAR(std::hypot(from.x, from.z), std::hypot(to.x, to.z), 1e-5);
    const double turned = std::atan2(double(from.x) * to.z - double(from.z) * to.x,
                                     double(from.x) * to.x + double(from.z) * to.z);
    // From z to x, as about y.
    EXPECT_NEAR(std::remainder(turned + 2 * 3.14159265358979 * revolutions[i], 2 * 3.14159265358979), 0,
                1e-4);
    EXPECT_EQ(points.positions[i], to);
  }
  const Value report = parseJson(readFile(stats), stats);
  EXPECT_EQ(report.find("nodes")->find("vortex")->find("tracers")->asInt(), std::int64_t(kTracers));
}

TEST_F(ParticlesWithoutAFluid, AreDrawnAndReplayed) {
  const std::string file = folder / "run.vtkhdf";
  const ChildResult result = run(kScene, {"--export", file, "--images", folder / "run"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NE(picture("run", 0), picture("run", 3));
  ASSERT_EQ(run(kScene, {"--set", "render.color.by=none", "--images", folder / "plain"}).code, 0);
  EXPECT_NE(picture("plain", 3), picture("run", 3)) << "the attribute does not colour them";
  const ChildResult replay =
      withPlugin({"render", file, "--scene", folder / "scene.json"}, {"--images", folder / "replay"});
  ASSERT_EQ(replay.code, 0) << replay.err;
  for (int frame = 0; frame < 4; ++frame) EXPECT_EQ(picture("replay", frame), picture("run", frame)) << frame;
}

/// An export of three tracers at one time, with these ids.
std::string exportOf(const std::string& file, VtkHdfType type, const VtkHdfValues& ids) {
  const std::vector<Vec3f> positions{{-0.4f, 0, 0}, {0, 0, 0}, {0.4f, 0, 0}}, velocities(3);
  const std::vector<std::int64_t> births{std::int64_t{1} << 40, 2, 3};
  VtkHdfWriter writer(file, {.attributes = {{"velocity", 3, VtkHdfType::kFloat32, ""},
                                            {"id", 1, type, ""},
                                            {"birth", 1, VtkHdfType::kInt64, ""}},
                             .fields = {}});
  writer.append({.time = 0,
                 .positions = positions,
                 .attributes = {flat(velocities), ids, std::span(births)},
                 .fields = {}});
  writer.setText("fluids", "vortex\n");
  writer.close();
  return file;
}

TEST_F(ParticlesWithoutAFluid, AreReplayedByIdsOf32BitsAsOf64) {
  const std::vector<std::int32_t> ids{0, 1, 2};
  const std::vector<std::int64_t> longIds{0, 1, 2};
  const auto replayed = [&](const std::string& name, VtkHdfType type, const VtkHdfValues& values) {
    const ChildResult replay = withPlugin({"render", exportOf(folder / name + ".vtkhdf", type, values),
                                           "--scene", folder.write("scene.json", kScene)},
                                          {"--images", folder / name, "--set", "render.color.by=id"});
    EXPECT_EQ(replay.code, 0) << replay.err;
    return picture(name, 0);
  };
  const std::string from32 = replayed("short", VtkHdfType::kInt32, std::span(ids));
  EXPECT_FALSE(from32.empty());
  EXPECT_EQ(from32, replayed("long", VtkHdfType::kInt64, std::span(longIds)));
}

TEST_F(ParticlesWithoutAFluid, KeepLongIdsFromExportsToUsd) {
  const std::vector<std::int64_t> ids{std::int64_t{1} << 40, (std::int64_t{1} << 53) - 1, 2};
  const std::string file = exportOf(folder / "long.vtkhdf", VtkHdfType::kInt64, std::span(ids));
  const ChildResult replay = withPlugin({"render", file, "--scene", folder.write("scene.json", kScene)},
                                        {"--usd", folder / "long.usda", "--set", "render.color.by=none"});
  ASSERT_EQ(replay.code, 0) << replay.err;
  // Layers of frames hold arrays as they are in memory.
  const std::string layer = readFile(folder / "long_frames/frame.00000.usdc");
  EXPECT_NE(layer.find(std::string_view(reinterpret_cast<const char*>(ids.data()),
                                        sizeof(std::int64_t) * ids.size())),
            std::string::npos);
  EXPECT_CONTAINS(layer, "int64[]");
  EXPECT_CONTAINS(layer, "primvars:birth");
}

TEST_F(ParticlesWithoutAFluid, HaveASurface) {
  const ChildResult result =
      run(with(R"("skin": {"type": "FluidSurface"})", "\"vortex.particles -> skin.fluid\""),
          {"--ply", folder / "meshes"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_CONTAINS(readFile(folder / "meshes/skin_00003.ply"), "element face");
}

TEST_F(ParticlesWithoutAFluid, AreRefusedByACouplingThatNamesTheLink) {
  const std::string scene = with(R"("box": {"type": "BoxMesh"}, "walls": {"type": "SemiAnalyticalSFI"})",
                                 "\"vortex.particles -> walls.fluid\", \"box.surface -> walls.solids\"");
  const ChildResult result = run(scene, {});
  EXPECT_NE(result.code, 0);
  EXPECT_CONTAINS(result.err, "walls");
  EXPECT_CONTAINS(result.err, "the particles of 'vortex.particles' meet no solids");
}

}  // namespace
}  // namespace weir::test
