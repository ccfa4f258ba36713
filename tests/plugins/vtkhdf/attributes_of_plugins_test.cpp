// Attributes that a module of a plugin adds stand in exports like the built-in ones.
#include <gtest/gtest.h>

#include "plugins/vtkhdf/vtkhdf_reader.h"
#include "tests/support/child_process.h"

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

TEST(AttributesOfPlugins, AreExportedWithTheirParticles) {
  const TemporaryFolder folder;
  const std::string file = folder / "run.vtkhdf";
  const ChildResult result = runWeir({"run", folder.write("s.json", kTagged), "--export", file, "--plugin",
                                      buildFolder() + "/lib/weir/test_plugins/tagger.so"});
  ASSERT_EQ(result.code, 0) << result.err;
  const VtkHdfStep step = VtkHdfReader(file).readLast();
  const VtkHdfArray *tag = step.find("tag"), *vector = step.find("tag_vector"),
                    *number = step.find("tag_number");
  ASSERT_TRUE(tag != nullptr && vector != nullptr && number != nullptr);
  EXPECT_EQ(vector->components, 3);
  const auto& tags = std::get<std::vector<float>>(tag->values);
  const auto& vectors = std::get<std::vector<float>>(vector->values);
  const auto& numbers = std::get<std::vector<std::int64_t>>(number->values);
  ASSERT_EQ(tags.size(), step.positions.size());
  ASSERT_EQ(vectors.size(), 3 * tags.size());
  ASSERT_GT(tags.size(), 100u);
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const auto id = static_cast<float>(numbers[i] - 7);
    EXPECT_EQ(tags[i], 3 * id + 1);
    EXPECT_EQ(vectors[3 * i + 1], 2 * id);
  }
}

}  // namespace
}  // namespace weir::test
