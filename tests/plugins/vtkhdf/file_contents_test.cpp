// weir info FILE: what files hold, and whether they are whole.
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene = R"({"weir": 1, "title": "A drop",
  "world": {"dt": 0.005, "frame_rate": 100, "duration": 0.05},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.2, 0.2, 0.2]}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.05}},
    "skin": {"type": "FluidSurface", "params": {"cell_size": 1}}},
  "links": ["block.particles -> water.initial", "water.fluid -> skin.fluid"]})";

class InfoOfFile : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = std::make_unique<TemporaryFolder>();
    const ChildResult run =
        runWeir({"run", folder->write("scene.json", kScene), "--device", "cpu", "--export",
                 *folder / "run.vtkhdf", "--export-surface", *folder / "skin.vtkhdf", "--checkpoint",
                 *folder / "run.h5", "--checkpoint-every", "4", "--series", *folder / "run.csv"});
    ASSERT_EQ(run.code, 0) << run.err;
  }
  static void TearDownTestSuite() { folder.reset(); }

  static ChildResult info(const std::string& file) { return runWeir({"info", file}); }
  static void expectRefused(const std::string& file, int code, std::initializer_list<std::string> parts) {
    const ChildResult result = info(file);
    EXPECT_EQ(result.code, code) << result.out;
    EXPECT_EQ(result.out, "");
    for (const std::string& part : parts) EXPECT_CONTAINS(result.err, part);
  }
  /// A copy, changed by `change`.
  static std::string copyOf(const std::string& name, const std::function<void(std::string&)>& change) {
    std::string bytes = readFile(*folder / name);
    change(bytes);
    return folder->write("copy_of_" + name, bytes);
  }

  static inline std::unique_ptr<TemporaryFolder> folder;
};

TEST_F(InfoOfFile, TellsOfACheckpoint) {
  const ChildResult result = info(*folder / "run.h5");
  EXPECT_EQ(result.code, 0) << result.err;
  for (const char* part :
       {"run.h5: a checkpoint, whole", "version: ", "back end: cpu", "frame: 4 at 0.04 s, after ",
        "particles of water: 64\n", "attributes of water: ", "position (3), velocity (3)",
        "all digests are right", "block (BoxSampler), water (ParticleFluid), skin (FluidSurface)"})
    EXPECT_CONTAINS(result.out, part);
}

TEST_F(InfoOfFile, TellsOfAnExportOfParticles) {
  const ChildResult result = info(*folder / "run.vtkhdf");
  EXPECT_EQ(result.code, 0) << result.err;
  for (const char* part : {"run.vtkhdf: an export of particles, whole", "frames: 6", "fluids: water",
                           "times: 0 s to 0.05 s", "particles: 64\n", "velocity (3)", "run: has ended"})
    EXPECT_CONTAINS(result.out, part);
}

TEST_F(InfoOfFile, TellsOfAnExportOfSurfaces) {
  const ChildResult result = info(*folder / "skin.vtkhdf");
  EXPECT_EQ(result.code, 0) << result.err;
  for (const char* part : {"skin.vtkhdf: an export of surfaces, whole", "surfaces: skin", "triangles: "})
    EXPECT_CONTAINS(result.out, part);
}

TEST_F(InfoOfFile, TheSceneInAFileCanBeRunAgain) {
  for (const char* name : {"run.h5", "run.vtkhdf"}) {
    SCOPED_TRACE(name);
    const ChildResult scene = runWeir({"info", "--scene", *folder / name});
    EXPECT_EQ(scene.code, 0) << scene.err;
    const Value read = parseJson(scene.out, name);
    ASSERT_NE(read.find("nodes"), nullptr);
    EXPECT_NE(read.find("nodes")->find("water"), nullptr);
  }
  EXPECT_EQ(runWeir({"info", "--scene"}).code, 2);
}

TEST_F(InfoOfFile, TellsOfMeshesAndParticles) {
  const std::string points =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string rows = "end_header\n0 0 0\n1 0 0\n0 2 0\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  const ChildResult particles = info(folder->write("particles.ply", points + rows));
  EXPECT_CONTAINS(particles.out, "particles.ply: particles, whole\n  particles: 3\n");
  const ChildResult mesh = info(folder->write("mesh.ply", points + face + rows + "3 0 1 2\n"));
  EXPECT_CONTAINS(mesh.out,
                  "mesh.ply: a mesh, whole\n  vertices: 3\n  triangles: 1\n  bounds: (0, 0, 0) to (1, 2, 0)");
}

TEST_F(InfoOfFile, ADamagedOneIsAnErrorThatSaysWhatIsWrong) {
  // A digest of an array stands beside it, so a bit of the array cannot change unseen.
  const std::string checkpoint = copyOf("run.h5", [](std::string& bytes) {
    const std::size_t text = bytes.find("ParticleFluid");
    ASSERT_NE(text, std::string::npos);
    bytes[text] = 'p';
  });
  expectRefused(checkpoint, 5, {checkpoint, "the checkpoint is damaged"});
  const std::string half = copyOf("run.h5", [](std::string& bytes) { bytes.resize(bytes.size() / 2); });
  expectRefused(half, 5, {half});
  const std::string short_ = copyOf("run.vtkhdf", [](std::string& bytes) { bytes.resize(bytes.size() / 2); });
  expectRefused(short_, 5, {short_});
}

TEST_F(InfoOfFile, ForeignFilesAreErrorsThatSayWhatIsAllowed) {
  expectRefused(folder->write("text.h5", "not HDF5"), 5, {"text.h5: this is not an HDF5 file"});
  fs::copy_file(*folder / "run.vtkhdf", *folder / "export.h5", fs::copy_options::overwrite_existing);
  expectRefused(*folder / "export.h5", 5, {"export.h5: this is not a checkpoint"});
  fs::copy_file(*folder / "run.h5", *folder / "checkpoint.vtkhdf", fs::copy_options::overwrite_existing);
  expectRefused(*folder / "checkpoint.vtkhdf", 5, {"checkpoint.vtkhdf: this HDF5 file holds no VTKHDF"});
  expectRefused(folder->write("film.mp4", "x"), 2,
                {"film.mp4' is of no known kind", ".h5", ".vtkhdf", ".ply"});
  expectRefused(folder->write("noending", "x"), 2, {"noending' has no ending"});
  expectRefused(*folder / "missing.h5", 5, {"missing.h5: there is no such file"});
  expectRefused(folder->path(), 5, {"this is a folder or a device, not a file"});
  expectRefused("/dev/zero", 5, {"this is a folder or a device, not a file"});
}

TEST_F(InfoOfFile, OneBadFileDoesNotHideTheOthers) {
  const ChildResult both = runWeir({"info", *folder / "missing.h5", *folder / "run.h5"});
  EXPECT_EQ(both.code, 5);
  EXPECT_CONTAINS(both.out, "run.h5: a checkpoint, whole");
  EXPECT_CONTAINS(both.err, "missing.h5: there is no such file");
}

}  // namespace
}  // namespace weir::test
