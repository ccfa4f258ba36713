// Meshes from PLY files in all encodings; damaged ones are read or refused.
#include "nodes/mesh_file/ply_mesh_reader.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "framework/base/error.h"
#include "tests/nodes/particle_file/ply_maker.h"
#include "tests/support/byte_mutator.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

constexpr const char* kHeader =
    "comment a box\nelement vertex 8\nproperty double x\nproperty uchar red\nproperty float y\nproperty "
    "float z\n"
    "element face 6\nproperty uchar material\nproperty list uchar int vertex_indices\nproperty list int "
    "float weights\n";

/// A box of 1 x 2 x 3 of squares, among properties that are none of the reader's business.
std::string box(const std::string& format, const char* header = kHeader) {
  constexpr int kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  PlyMaker ply(format, header);
  for (int i = 0; i < 8; ++i)
    ply.add(i & 1 ? 1.0 : 0.0)
        .add(std::uint8_t{9})
        .add(i & 2 ? 2.0f : 0.0f)
        .add(i & 4 ? 3.0f : 0.0f)
        .endRow();
  for (const auto& q : kQuads) {
    ply.add(std::uint8_t{1}).add(std::uint8_t{4});
    for (const int i : q) ply.add(i);
    ply.add(2).add(0.5f).add(1.5f).endRow();
  }
  return ply.text();
}

class PlyMesh : public testing::Test {
 protected:
  TriangleMesh read(const std::string& content) const {
    return PlyMeshReader().read(folder.write("m.ply", content));
  }
  std::string refusal(const std::string& content) const {
    const Error e = errorOf([&] { read(content); });
    EXPECT_EQ(e.kind(), ErrorKind::kIo);
    EXPECT_EQ(e.location().file, folder / "m.ply");
    return e.what();
  }

  TemporaryFolder folder;
};

TEST_F(PlyMesh, ReadsABoxInAllEncodings) {
  for (const char* format : kPlyFormats) {
    SCOPED_TRACE(format);
    const TriangleMesh mesh = read(box(format));
    EXPECT_EQ(mesh.vertices.size(), 8u);
    EXPECT_EQ(mesh.triangles.size(), 12u);
    EXPECT_TRUE(diagnose(mesh).good()) << diagnose(mesh).message();
    EXPECT_NEAR(mesh.volume(), 6, 1e-6);
  }
}

constexpr const char* kPoints =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";

std::string pointsAnd(std::string_view rest) {
  std::string text = kPoints;
  text += rest;
  return text;
}

TEST_F(PlyMesh, ReadsStripsOfTriangles) {
  const TriangleMesh mesh = read(pointsAnd(
      "element tristrips 1\nproperty list int int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n"
      "8 0 1 2 3 -1 0 1 3\n"));
  EXPECT_EQ(mesh.triangles, (std::vector<Vec3i>{{0, 1, 2}, {2, 1, 3}, {0, 1, 3}}));
}

TEST_F(PlyMesh, PointsAndLinesAreNoTriangles) {
  EXPECT_TRUE(read(pointsAnd("end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n")).empty());
  EXPECT_TRUE(read(pointsAnd("element face 2\nproperty list uchar int vertex_indices\nend_header\n"
                             "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 0 1\n0\n"))
                  .empty());
}

TEST_F(PlyMesh, SaysWhatIsWrongAndWhere) {
  EXPECT_CONTAINS(refusal("ply\nformat ascii"), "m.ply:2:1: the file ends within its header");
  EXPECT_CONTAINS(refusal(""), "does not begin with 'ply'");
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
  EXPECT_CONTAINS(refusal(kPoints + faces + points + "3 0 1 4\n"), "m.ply:14:1: a face names vertex 4 of 4");
  EXPECT_CONTAINS(refusal(kPoints + faces + points + "3 0 1 -1\n"), "a face names vertex -1 of 4");
  EXPECT_CONTAINS(refusal(kPoints + faces + points + "200 0 1 2\n"), "longer than the file");
  EXPECT_CONTAINS(refusal(kPoints + faces + points), "ends too early");
  EXPECT_CONTAINS(
      refusal(kPoints + std::string("element face 1\nproperty int material\nend_header\n") + points + "3\n"),
      "has no list of integers 'vertex_indices'");
  EXPECT_CONTAINS(refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n"),
                  "no property 'y'");
  EXPECT_CONTAINS(
      refusal("ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"),
      "no element 'vertex'");
  EXPECT_CONTAINS(
      refusal("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
              "property float z\nend_header\n"),
      "4000000000 vertices");
}

// WEIR_TEST_MUTANTS is how many there are in all.
TEST_F(PlyMesh, DamagedFilesAreReadOrRefused) {
  const char* asked = std::getenv("WEIR_TEST_MUTANTS");
  const std::uint64_t mutants = (asked != nullptr ? std::strtoull(asked, nullptr, 10) : 3000) / 3;
  for (const char* format : kPlyFormats) {
    SCOPED_TRACE(format);
    const std::string content = box(format);
    std::uint64_t refused = 0;
    for (std::uint64_t seed = 0; seed < mutants; ++seed) {
      try {
        const TriangleMesh mesh = read(damaged(content, seed));
        for (const Vec3i& t : mesh.triangles)
          for (int k = 0; k < 3; ++k) EXPECT_LT(static_cast<std::size_t>(t[k]), mesh.vertices.size());
      } catch (const Error& e) {
        ++refused;
        EXPECT_EQ(e.kind(), ErrorKind::kIo);
        EXPECT_EQ(e.location().file, folder / "m.ply");
      }
    }
    EXPECT_GT(refused, mutants / 10);
    EXPECT_LT(refused, mutants);
  }
}

}  // namespace
}  // namespace weir::test
