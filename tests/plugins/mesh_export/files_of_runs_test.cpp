// The options --ply, --obj and --ply-particles as a user gives them.
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/graph/plugin.h"
#include "nodes/mesh_file/mesh_reader.h"
#include "nodes/particle_file/ply_reader.h"
#include "tests/support/child_process.h"

namespace weir::test {
namespace {

constexpr const char* kScene = R"({
  "weir": 1,
  "world": { "gravity": [0, 0, 0], "dt": 0.002, "frame_rate": 50, "duration": 0.04 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.1, 0.1, 0.1], "velocity": [1, 0, 0] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.02 } },
    "skin": { "type": "FluidSurface" }
  },
  "links": ["block.particles -> water.initial", "water.fluid -> skin.fluid"]
})";

constexpr const char* kNoSurface = R"({
  "weir": 1, "world": { "duration": 0.04 }, "nodes": { "box": { "type": "BoxMesh" } }
})";

class FilesOfRuns : public testing::Test {
 protected:
  ChildResult run(std::vector<std::string> options, const char* scene = kScene) {
    options.insert(options.begin(), {"run", folder.write("scene.json", scene), "--threads", "2"});
    return runWeir(options);
  }
  std::size_t count(const std::string& name) const {
    const std::filesystem::directory_iterator files(folder / name);
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
  }

  TemporaryFolder folder;
};

TEST_F(FilesOfRuns, SurfacesAreReadBackByAssimp) {
  const std::string library = buildFolder() + "/lib/weir/plugins/weir_assimp.so";
  if (!std::filesystem::exists(library)) GTEST_SKIP() << "this build has no plugin assimp";
  const ChildResult result = run({"--ply", folder / "ply", "--obj", folder / "obj"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(count("ply"), 3u);
  EXPECT_EQ(count("obj"), 3u);
  Registry registry;
  const Plugin plugin(library, registry);
  const auto reader = std::move(registry.createServices<MeshReader>().at(0).implementation);
  double firstX = 0;
  for (int frame = 0; frame < 3; ++frame) {
    const std::string name = "/skin_0000" + std::to_string(frame);
    // Assimp gives each corner of an OBJ file with normals a vertex of its own.
    const TriangleMesh obj = cleaned(reader->read(folder / ("obj" + name + ".obj")));
    const TriangleMesh ply = reader->read(folder / ("ply" + name + ".ply"));
    const MeshDiagnosis diagnosis = diagnose(obj);
    EXPECT_TRUE(diagnosis.good()) << diagnosis.message();
    EXPECT_TRUE(diagnose(ply).good());
    EXPECT_NEAR(obj.volume(), 1e-3, 1e-4);
    EXPECT_NEAR(ply.volume(), obj.volume(), 1e-9);
    EXPECT_EQ(ply.triangles.size(), obj.triangles.size());
    // It flies at 1 m/s.
    if (frame == 0) firstX = double(obj.bounds().center().x);
    EXPECT_NEAR(double(obj.bounds().center().x) - firstX, 0.02 * frame, 4e-3);
  }
}

TEST_F(FilesOfRuns, ParticlesAreReadBackWithAllThatTheyHave) {
  const ChildResult result = run({"--ply-particles", folder / "points"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(count("points"), 3u);
  const ParticleData read = PlyReader().read(folder / "points/water_00002.ply");
  ASSERT_EQ(read.positions.size(), 125u);
  for (const Vec3f& v : read.velocities) EXPECT_NEAR(v.x, 1, 0.5);
  EXPECT_NE(std::find(read.unused.begin(), read.unused.end(), "density"), read.unused.end());
}

TEST_F(FilesOfRuns, SayWhatIsMissingBeforeTheRun) {
  const ChildResult surface = run({"--ply", folder / "ply"}, kNoSurface);
  EXPECT_EQ(surface.code, 5);
  EXPECT_NE(surface.err.find("the scene has no FluidSurface"), std::string::npos) << surface.err;
  const ChildResult particles = run({"--ply-particles", folder / "ply"}, kNoSurface);
  EXPECT_EQ(particles.code, 5);
  EXPECT_NE(particles.err.find("the scene has no particles"), std::string::npos) << particles.err;
  const ChildResult file = run({"--obj", folder.write("taken", "")});
  EXPECT_EQ(file.code, 5);
  EXPECT_NE(file.err.find("it is not a folder"), std::string::npos) << file.err;
  EXPECT_EQ(readFile(folder / "taken"), "");
}

}  // namespace
}  // namespace weir::test
