// Damaged VTKHDF files are either read, or refused with an error that names the file.
#include <fstream>

#include "framework/base/error.h"
#include "plugins/vtkhdf/vtkhdf_particle_reader.h"
#include "tests/plugins/vtkhdf/sample_run.h"
#include "tests/support/byte_mutator.h"
#include "tests/support/child_process.h"

namespace weir::test {
namespace {

using VtkHdfDamageTest = InFolder;

constexpr std::uint64_t kMutations = 1000;
/// Where most of what HDF5 says of the file stands; the rest is numbers, and room for more of them.
constexpr std::size_t kHeadSize = 20'000;

std::string smallFile(const std::filesystem::path& file) {
  VtkHdfWriter writer(file, {.attributes = {{"velocity", 3}, {"id", 1, VtkHdfType::kInt32}}, .fields = {}});
  for (int s = 0; s < 2; ++s) {
    const SampleStep step(s, 4 + s);
    writer.append({.time = step.time,
                   .positions = step.positions,
                   .attributes = {flat(step.velocities), std::span(step.ids)},
                   .fields = {}});
  }
  writer.close();
  return readFile(file);
}

TEST_F(VtkHdfDamageTest, IsReadOrRefused) {
  const auto file = folder / "run.vtkhdf";
  const std::string whole = smallFile(file), head = whole.substr(0, kHeadSize);
  std::uint64_t refused = 0;
  for (std::uint64_t seed = 0; seed < kMutations; ++seed) {
    SCOPED_TRACE(seed);
    std::ofstream(file, std::ios::binary | std::ios::trunc) << damaged(whole, seed);
    try {
      const ParticleData data = VtkHdfParticleReader().read(file);
      EXPECT_FALSE(data.positions.empty());
      EXPECT_EQ(data.positions.size(), data.velocities.size());
      for (const Vec3f& p : data.positions) EXPECT_TRUE(isFinite(p));
      for (const Vec3f& v : data.velocities) EXPECT_TRUE(isFinite(v));
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(error.kind(), ErrorKind::kIo);
      EXPECT_EQ(error.location().file, file.string());
    }
  }
  EXPECT_GT(refused, kMutations / 10);
  EXPECT_LT(refused, kMutations);
}

}  // namespace
}  // namespace weir::test
