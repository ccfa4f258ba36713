// The section "export": which attributes and frames are written, and how exactly positions are.
#include "plugins/vtkhdf/export_settings.h"

#include <cmath>
#include <filesystem>
#include <random>

#include "plugins/vtkhdf/hdf5.h"
#include "tests/plugins/vtkhdf/sample_run.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

TEST(ExportSettings, RoundsNoFartherThanAllowed) {
  ExportSettings settings;
  EXPECT_EQ(settings.grid(), 0);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-3, 3);
  for (const float error : {1e-5f, 3e-4f, 0.01f, 0.25f}) {
    settings.positionError.set(error);
    const float grid = settings.grid();
    EXPECT_LE(grid, 2 * error);
    EXPECT_GT(grid, error);
    int exponent = 0;
    EXPECT_EQ(std::frexp(grid, &exponent), 0.5f) << "a power of two";
    for (int i = 0; i < 1000; ++i) {
      const float x = place(random);
      EXPECT_LE(std::abs(double(roundedTo(grid, x)) - double(x)), 0.5 * double(grid));
    }
  }
  EXPECT_EQ(roundedTo(1e-5f, 3e38f), 3e38f);
}

TEST(ExportSettings, ChooseFrames) {
  const auto chosen = [](const ExportSettings& settings, double frameRate) {
    std::vector<std::int64_t> frames;
    for (std::int64_t k = 0; k < 13; ++k)
      if (settings.wants(k, frameRate)) frames.push_back(k);
    return frames;
  };
  ExportSettings settings;
  EXPECT_EQ(chosen(settings, 30).size(), 13u);
  settings.every.set(5);
  EXPECT_EQ(chosen(settings, 30), (std::vector<std::int64_t>{0, 5, 10}));
  settings.every.set(1);
  settings.rate.set(10.0);
  EXPECT_EQ(chosen(settings, 30), (std::vector<std::int64_t>{0, 3, 6, 9, 12}));
  settings.rate.set(12.0);  // not at equal distances: at or behind 2.5, 5, 7.5, 10, 12.5
  EXPECT_EQ(chosen(settings, 30), (std::vector<std::int64_t>{0, 3, 5, 8, 10}));
  settings.rate.set(100.0);
  EXPECT_EQ(chosen(settings, 30).size(), 13u);
}

constexpr const char* kScene = R"({"weir": 1,
  "world": {"dt": 0.005, "frame_rate": 50, "duration": 0.2},
  "nodes": {"block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.1, 0.1, 0.1], "jitter": 0.1}},
            "water": {"type": "ParticleFluid", "params": {"spacing": 0.02}}},
  "links": ["block.particles -> water.initial"]})";

class ExportOfRun : public testing::Test {
 protected:
  ChildResult run(const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> all{
        "run", folder.write("scene.json", kScene), "--device", "cpu", "--export", folder / name};
    all.insert(all.end(), more.begin(), more.end());
    return runWeir(all);
  }
  TemporaryFolder folder;
};

TEST_F(ExportOfRun, HoldsWhatWasChosen) {
  ASSERT_EQ(run("all.vtkhdf", {}).code, 0);
  const ChildResult result = run("some.vtkhdf", {"--set", "export.attributes=[\"velocity\"]", "--set",
                                                 "export.every=3", "--set", "export.position_error=1e-4"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_FALSE(contains(result.err, "leaves out")) << result.err;
  // 2^-13 m is the largest power of two that is not above twice the error that was allowed.
  EXPECT_CONTAINS(result.err + result.out, "multiples of 0.000122 m and are off by 6.1e-05 m at most");
  const hdf5::Session session;
  hdf5::File file = hdf5::File::open(folder / "some.vtkhdf");
  EXPECT_EQ(file.root().group("simulation").readText("position_error"), "6.10351562e-05");
  const VtkHdfReader all(folder / "all.vtkhdf"), some(folder / "some.vtkhdf");
  ASSERT_EQ(all.times().size(), 11u);
  ASSERT_EQ(some.times().size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    const VtkHdfStep exact = all.read(3 * k), rounded = some.read(k);
    EXPECT_EQ(exact.time, rounded.time);
    ASSERT_EQ(rounded.arrays.size(), 1u);
    EXPECT_TRUE(exact.velocities() == rounded.velocities());
    ASSERT_EQ(exact.positions.size(), rounded.positions.size());
    for (std::size_t i = 0; i < exact.positions.size(); ++i) {
      const Vec3f error = exact.positions[i] - rounded.positions[i];
      EXPECT_LE(std::max({std::abs(error.x), std::abs(error.y), std::abs(error.z)}), 1e-4f);
    }
    EXPECT_FALSE(exact.positions == rounded.positions) << "frame " << k;
  }
}

TEST_F(ExportOfRun, GoesOnBetweenFramesThatAreWritten) {
  const std::vector<std::string> settings{"--set", "export.every=4"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), settings.begin(), settings.end());
    return more;
  };
  ASSERT_EQ(run("whole.vtkhdf", settings).code, 0);
  const std::string state = folder / "state.h5";
  // Frame 6 makes a checkpoint before any frame was written after frame 5.
  for (const char* last : {"5", "6", "10"}) {
    std::vector<std::string> more{"--checkpoint", state, "--checkpoint-every", "1", "--frames", last};
    if (std::filesystem::exists(state)) more.insert(more.end(), {"--resume", state});
    const ChildResult result = run("parts.vtkhdf", with(more));
    ASSERT_EQ(result.code, 0) << result.err;
  }
  const VtkHdfReader whole(folder / "whole.vtkhdf"), parts(folder / "parts.vtkhdf");
  ASSERT_EQ(whole.times(), parts.times());
  ASSERT_EQ(whole.times().size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(whole.read(k).positions == parts.read(k).positions) << k;
}

TEST_F(ExportOfRun, IsReadAtATime) {
  ASSERT_EQ(run("run.vtkhdf", {}).code, 0);
  const auto runFrom = [&](const std::string& time) {
    const std::string text =
        R"({"weir": 1, "world": {"dt": 0.005, "frame_rate": 50, "duration": 0.2},
            "nodes": {"file": {"type": "ParticleFile", "params": {"file": "run.vtkhdf", "time": )" +
        time + R"(}}, "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 0}}},
            "links": ["file.particles -> water.initial"]})";
    return runWeir({"run", folder.write("from.json", text), "--device", "cpu", "--frames", "0", "--export",
                    folder / "from.vtkhdf"});
  };
  const VtkHdfReader reader(folder / "run.vtkhdf");
  ASSERT_EQ(runFrom("0.0801").code, 0);
  VtkHdfStep step = VtkHdfReader(folder / "from.vtkhdf").read(0);
  EXPECT_TRUE(step.positions == reader.read(4).positions);
  EXPECT_TRUE(step.velocities() == reader.read(4).velocities());
  EXPECT_GT(length(step.velocities().front()), 0.5f) << "it has been falling";
  ASSERT_EQ(runFrom("null").code, 0);
  EXPECT_TRUE(VtkHdfReader(folder / "from.vtkhdf").read(0).positions == reader.read(10).positions);
  const ChildResult late = runFrom("0.3");
  EXPECT_EQ(late.code, 5);
  EXPECT_CONTAINS(late.err, "no moment at 0.3 s");
  EXPECT_CONTAINS(late.err, "from 0 to 0.2 s");
}

TEST_F(ExportOfRun, SaysWhatCannotBeChosen) {
  const ChildResult unknown = run("run.vtkhdf", {"--set", "export.attributes=[\"velocty\"]"});
  EXPECT_EQ(unknown.code, 3);
  EXPECT_CONTAINS(unknown.err, "no attribute 'velocty' that could be exported");
  EXPECT_CONTAINS(unknown.err, "velocity");
  EXPECT_EQ(run("run.vtkhdf", {"--set", "export.every=2", "--set", "export.rate=10"}).code, 3);
  EXPECT_EQ(run("run.vtkhdf", {"--set", "export.every=0"}).code, 3);
}

}  // namespace
}  // namespace weir::test
