// --vdb, read back by OpenVDB: volume and centre of mass of the fluid are in the grid.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <filesystem>

#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

constexpr const char* kScene = R"({"weir": 1,
  "world": {"dt": 0.005, "frame_rate": 50, "duration": 0.06},
  "nodes": {"block": {"type": "BoxSampler", "params": {"min": [0.1, -0.2, 0.3], "max": [0.3, 0, 0.4]}},
            "water": {"type": "ParticleFluid", "params": {"spacing": 0.02}}},
  "links": ["block.particles -> water.initial"]})";

class VolumeExportTest : public testing::Test {
 protected:
  VolumeExportTest() { openvdb::initialize(); }

  ChildResult run(std::vector<std::string> more) const {
    std::vector<std::string> all{"run", scene, "--device", "cpu", "--vdb", folder / "volume"};
    all.insert(all.end(), more.begin(), more.end());
    return runWeir(all);
  }

  openvdb::FloatGrid::Ptr gridOf(int frame) const {
    openvdb::io::File file(folder / "volume/frame_0000" + std::to_string(frame) + ".vdb");
    file.open();
    return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density"));
  }

  TemporaryFolder folder;
  std::string scene = folder.write("scene.json", kScene);
};

TEST_F(VolumeExportTest, KeepsVolumeAndCentre) {
  const std::string series = folder / "s.jsonl";
  const ChildResult result = run({"--series", series});
  ASSERT_EQ(result.code, 0) << result.err;
  constexpr double kSide = 0.04, kVolume = 500 * 0.02 * 0.02 * 0.02;
  for (int frame = 0; frame < 4; ++frame) {
    const openvdb::FloatGrid::Ptr grid = gridOf(frame);
    EXPECT_EQ(grid->getGridClass(), openvdb::GRID_FOG_VOLUME);
    EXPECT_NEAR(grid->voxelSize().x(), kSide, 1e-7);
    EXPECT_NEAR(grid->metaValue<double>("time"), 0.02 * frame, 1e-12);
    double sum = 0, largest = 0;
    openvdb::Vec3d centre(0);
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
      sum += *voxel;
      largest = std::max<double>(largest, *voxel);
      centre += *voxel * grid->indexToWorld(voxel.getCoord());
    }
    // Numbers are kept with 11 bits.
    EXPECT_NEAR(sum * kSide * kSide * kSide / kVolume, 1, 5e-4);
    EXPECT_NEAR(largest, 1, 0.1);
    centre /= sum;
    EXPECT_NEAR(centre.x(), 0.2, 1e-3);
    EXPECT_NEAR(centre.z(), 0.35, 1e-3);
    // It falls: with semi-implicit Euler steps a little more than g·t²/2.
    const double t = 0.02 * frame;
    EXPECT_NEAR(centre.y(), -0.1 - 0.5 * 9.8 * t * (t + 0.005), 1e-3);
  }
}

TEST_F(VolumeExportTest, HasVoxelsOfTheSizeThatIsAskedFor) {
  ASSERT_EQ(run({"--set", "vdb.voxel=1", "--frames", "0"}).code, 0);
  EXPECT_NEAR(gridOf(0)->voxelSize().x(), 0.02, 1e-7);
}

TEST_F(VolumeExportTest, SaysWhyItCannotBeWritten) {
  folder.write("volume", "a file");
  const ChildResult result = run({});
  EXPECT_EQ(result.code, 5);
  EXPECT_CONTAINS(result.err, folder / "volume");
}

}  // namespace
}  // namespace weir::test
