// Attributes that a module of a plugin adds stand in exports like the built-in ones.
#include <gtest/gtest.h>

#include "plugins/vtkhdf/vtkhdf_reader.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

constexpr const char* kTagged = R"({
  "weir": 1, "world": { "dt": 0.005, "duration": 0.2, "frame_rate": 10 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [-0.3, 0, -0.3], "max": [0.3, 0.5, 0.3] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.1 },
               "modules": { "tag": { "type": "Tagger", "after": "boundary" } } } },
  "links": [ "block.particles -> water.initial" ]
})";

const std::string kTagger = buildFolder() + "/lib/weir/test_plugins/tagger.so";

TEST(AttributesOfPlugins, AreExportedWithTheirParticles) {
  const TemporaryFolder folder;
  const std::string file = folder / "run.vtkhdf";
  const ChildResult result =
      runWeir({"run", folder.write("s.json", kTagged), "--export", file, "--plugin", kTagger});
  ASSERT_EQ(result.code, 0) << result.err;
  const VtkHdfStep step = VtkHdfReader(file).readLast();
  const VtkHdfArray *tag = step.find("tag"), *vector = step.find("tag_vector"),
                    *matrix = step.find("tag_matrix"), *number = step.find("tag_number");
  ASSERT_TRUE(tag != nullptr && vector != nullptr && matrix != nullptr && number != nullptr);
  EXPECT_EQ(vector->components, 3);
  EXPECT_EQ(matrix->components, 9);
  const auto& tags = std::get<std::vector<float>>(tag->values);
  const auto& vectors = std::get<std::vector<float>>(vector->values);
  const auto& matrices = std::get<std::vector<float>>(matrix->values);
  const auto& numbers = std::get<std::vector<std::int64_t>>(number->values);
  ASSERT_EQ(tags.size(), step.positions.size());
  ASSERT_EQ(vectors.size(), 3 * tags.size());
  ASSERT_GT(tags.size(), 100u);
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const auto id = static_cast<float>(numbers[i] - 7);
    EXPECT_EQ(tags[i], 3 * id + 1);
    EXPECT_EQ(vectors[3 * i + 1], 2 * id);
    EXPECT_EQ(matrices[9 * i + 4], 2 * id);  // of the second row
    EXPECT_EQ(matrices[9 * i + 7], 0);
  }
}

/// A run that was resumed must write the same bytes of every column as one that was not.
TEST(AttributesOfPlugins, AreInCheckpointsAndPointClouds) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("s.json", kTagged), state = folder / "state.h5";
  const auto run = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> arguments{"run", scene, "--plugin", kTagger, "--ply-particles", folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ChildResult result = runWeir(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
  };
  run("whole", {});
  run("resumed", {"--checkpoint", state, "--checkpoint-every", "1", "--frames", "1"});
  run("resumed", {"--resume", state});
  const std::string last = "/water_00002.ply";
  const std::string whole = readFile((folder / "whole") + last);
  EXPECT_CONTAINS(whole, "property float tag_matrix_yy");
  EXPECT_TRUE(whole == readFile((folder / "resumed") + last));
}

}  // namespace
}  // namespace weir::test
