#include "plugins/mesh_export/mesh_text.h"

#include <gtest/gtest.h>

#include <cstring>

#include "nodes/particle_file/ply_reader.h"
#include "tests/support/child_process.h"

namespace weir {
namespace {

const std::vector<Vec3f> kVertices{{0, 0, 0}, {1, 0, 0}, {0, 0.1f, 0}, {0, 0, -2.5e-7f}};
const std::vector<Vec3f> kNormals{{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Vec3i> kTriangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
const MeshSpan kMesh{kVertices, kNormals, kTriangles};

TEST(ObjText, IsAsTheFormatSays) {
  EXPECT_EQ(objOf(kMesh),
            "# made by Weir, lengths in metres\n"
            "v 0 0 0\nv 1 0 0\nv 0 0.1 0\nv 0 0 -2.5e-07\n"
            "vn -1 0 0\nvn 1 0 0\nvn 0 1 0\nvn 0 0 1\n"
            "f 1//1 3//3 2//2\nf 1//1 2//2 4//4\nf 2//2 3//3 4//4\nf 3//3 1//1 4//4\n");
}

TEST(PlyText, HasVerticesAndTrianglesBehindItsHeader) {
  const std::string text = plyOf(kMesh);
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment made by Weir, lengths in metres\nelement vertex 4\n"
      "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
      "property float nz\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
  ASSERT_EQ(text.substr(0, header.size()), header);
  ASSERT_EQ(text.size(), header.size() + 4 * 24 + 4 * 13);
  const char* at = text.data() + header.size();
  for (int i = 0; i < 4; ++i, at += 24) {
    EXPECT_EQ(std::memcmp(at, &kVertices[i], 12), 0);
    EXPECT_EQ(std::memcmp(at + 12, &kNormals[i], 12), 0);
  }
  for (int t = 0; t < 4; ++t, at += 13) {
    EXPECT_EQ(*at, 3);
    EXPECT_EQ(std::memcmp(at + 1, &kTriangles[t], 12), 0);
  }
}

TEST(PlyText, OfNothingIsAFileToo) {
  EXPECT_NE(plyOf(MeshSpan{}).find("element face 0\n"), std::string::npos);
  EXPECT_EQ(objOf(MeshSpan{}), "# made by Weir, lengths in metres\n");
}

TEST(PlyText, ParticlesAreReadBackByTheNodeForParticleFiles) {
  const std::vector<float> vectors{1, 2, 3, 4, 5, 6, 0.1f, -7, 1e-30f, 1e30f, 0, 8};
  const std::vector<std::int32_t> ids{7, -3};
  const std::span<const float> all(vectors);
  std::vector<PlyColumn> columns{{"id", std::span<const std::int32_t>(ids)}};
  const char* names[] = {"x", "y", "z", "vx", "vy", "vz"};
  for (int k = 0; k < 6; ++k) columns.push_back({names[k], all, 6, k});
  const test::TemporaryFolder folder;
  const ParticleData read = PlyReader().read(folder.write("a.ply", plyOf(2, columns)));
  EXPECT_EQ(read.positions, (std::vector<Vec3f>{{1, 2, 3}, {0.1f, -7, 1e-30f}}));
  EXPECT_EQ(read.velocities, (std::vector<Vec3f>{{4, 5, 6}, {1e30f, 0, 8}}));
  EXPECT_EQ(read.unused, (std::vector<std::string>{"id"}));
}

TEST(PlyText, LongIntsAreDoubles) {
  constexpr std::int64_t kLarge = (std::int64_t{1} << 53) - 1;
  const std::vector<std::int64_t> ids{kLarge, 3};
  const std::vector<float> heights{0.5f, 2};
  const std::string text =
      plyOf(2, {{"id", std::span<const std::int64_t>(ids)}, {"height", std::span<const float>(heights)}});
  const std::string end = "property double id\nproperty float height\nend_header\n";
  const std::size_t at = text.find(end);
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(text.size(), at + end.size() + 2 * (sizeof(double) + sizeof(float)));
  double first = 0;
  float height = 0;
  const char* second = text.data() + at + end.size() + sizeof(double) + sizeof(float);
  std::memcpy(&first, text.data() + at + end.size(), sizeof first);
  std::memcpy(&height, second + sizeof(double), sizeof height);
  EXPECT_EQ(static_cast<std::int64_t>(first), kLarge);
  EXPECT_EQ(height, 2);
}

}  // namespace
}  // namespace weir
