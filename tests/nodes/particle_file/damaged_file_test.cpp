// Damaged particle files are either read, or refused with an error that names the file.
#include <gtest/gtest.h>

#include "framework/base/error.h"
#include "nodes/particle_file/csv_reader.h"
#include "nodes/particle_file/ply_reader.h"
#include "tests/nodes/particle_file/ply_maker.h"
#include "tests/support/byte_mutator.h"
#include "tests/support/child_process.h"

namespace weir::test {
namespace {

constexpr std::uint64_t kMutations = 2000;

void readDamaged(const ParticleReader& reader, const std::string& content) {
  const TemporaryFolder folder;
  int refused = 0;
  for (std::uint64_t seed = 0; seed < kMutations; ++seed) {
    SCOPED_TRACE(seed);
    const std::string file = folder.write("p", damaged(content, seed));
    try {
      const ParticleData data = reader.read(file);
      EXPECT_FALSE(data.positions.empty());
      EXPECT_EQ(data.positions.size(), data.velocities.size());
      for (const Vec3f& p : data.positions) EXPECT_TRUE(isFinite(p));
      for (const Vec3f& v : data.velocities) EXPECT_TRUE(isFinite(v));
    } catch (const Error& error) {
      ++refused;
      EXPECT_EQ(error.kind(), ErrorKind::kIo);
      EXPECT_EQ(error.location().file, file);
      EXPECT_NE(error.message(), "");
    }
  }
  // If all or none were refused, the damage would not be what this test needs.
  EXPECT_GT(refused, kMutations / 10);
  EXPECT_LT(refused, kMutations);
}

TEST(DamagedParticleFile, Csv) {
  readDamaged(
      CsvReader(),
      "# a "
      "comment\r\nid,\"x\",y,z,vx,vy,vz\r\n0,0.5,-1,2e-3,0,0,1\r\n\n1,+7,8.25,9,1,2,3\n2,\"1\",2,3,4,5,6");
}

TEST(DamagedParticleFile, Ply) {
  for (const char* format : kPlyFormats) {
    SCOPED_TRACE(format);
    readDamaged(PlyReader(), samplePly(format));
  }
}

}  // namespace
}  // namespace weir::test
