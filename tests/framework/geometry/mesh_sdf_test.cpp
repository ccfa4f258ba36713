// Grids of signed distances against closed forms, and against asking every triangle.
#include "framework/geometry/mesh_sdf.h"
#include "framework/compute/dispatch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/framework/geometry/mesh_sdf_kernel.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

constexpr float kCell = 0.05f;
constexpr float kBand = 0.2f;
constexpr float kCoarse = MeshSdfView::kBrick * kCell;

std::vector<Vec3f> randomPoints(int count, float reach) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> coordinate(-reach, reach);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i)
    points.push_back({coordinate(random), coordinate(random), coordinate(random)});
  return points;
}

std::string print(const Vec3f& p) {
  return std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z);
}

TriangleMesh boxOf(const Vec3f& half) {
  return boxMesh(-half, half);
}

/// Every triangle with vertices of its own, as an STL file has them.
TriangleMesh unwelded(const TriangleMesh& mesh) {
  TriangleMesh result;
  for (const Vec3i& t : mesh.triangles) {
    const int first = static_cast<int>(result.vertices.size());
    for (int k = 0; k < 3; ++k) result.vertices.push_back(mesh.vertices[t[k]]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

class MeshSdfs : public OnDevice {
 protected:
  /// Replaces `warnings`.
  MeshSdf build(const TriangleMesh& mesh, float cellSize = kCell, float band = kBand) {
    warnings.clear();
    return MeshSdf(*device, mesh, cellSize, band, warnings);
  }

  std::vector<SignedDistance> query(const MeshSdf& sdf, const std::vector<Vec3f>& points,
                                    bool inverted = false) {
    const Array<Vec3f> asked(*device, points);
    Array<SignedDistance> found(*device, asked.size());
    dispatch(*device, [&](auto& d) { queryAll(d, sdf.view(inverted), asked.view(), found.view()); });
    return found.toHost();
  }

  /// The number of bricks without nodes, and of those with.
  std::pair<int, int> bricks(const MeshSdf& sdf) {
    const MeshSdfView view = sdf.view(false);
    std::vector<int> index(static_cast<std::size_t>(view.bricks.x) * view.bricks.y * view.bricks.z);
    device->download(index.data(), view.brickIndex, index.size() * sizeof(int));
    const auto coarse = std::count(index.begin(), index.end(), -1);
    return {static_cast<int>(coarse), static_cast<int>(index.size()) - static_cast<int>(coarse)};
  }

  std::vector<std::string> warnings;
};

/// Of trilinear interpolation of |p| in cells of size h around a point with |p| = r: h²/8 times the sum of
/// the second derivatives, which is 2/|p|.
double interpolationError(double h, double r) {
  return h * h / (4 * (r - std::sqrt(3.0) * h));
}

TEST_P(MeshSdfs, OfASphere) {
  const TriangleMesh mesh = icosphere(4);
  const double facets = icosphereSagitta(mesh);
  const MeshSdf sdf = build(mesh);
  EXPECT_TRUE(warnings.empty());
  const auto points = randomPoints(20000, 1.4f);
  const auto found = query(sdf, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = length(points[i]), expected = r - 1;
    const bool inBand = std::abs(expected) < kBand;
    if (!inBand && r < 1) continue;  // towards the centre, the coarse grid has no small bound of its error
    const double max = facets + interpolationError(inBand ? kCell : kCoarse, r) + 1e-6;
    ASSERT_NEAR(found[i].distance, expected, max) << print(points[i]);
    if (inBand) {
      ASSERT_GT(dot(found[i].normal, normalized(points[i])), 0.995) << print(points[i]);
    }
  }
}

TEST_P(MeshSdfs, OfABoxAndAPlateThinnerThanACell) {
  for (const Vec3f& half : {Vec3f{0.5f, 0.8f, 0.3f}, Vec3f{0.5f, 0.3f * kCell, 0.7f}}) {
    Shape box;
    box.halfSize = half;
    const MeshSdf sdf = build(boxOf(half));
    const auto points = randomPoints(20000, 1);
    const auto found = query(sdf, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float expected = signedDistance(box, points[i]).distance;
      // No distance changes by more than the way to the corners of a cell.
      const float cell = std::abs(expected) < kBand ? kCell : kCoarse;
      ASSERT_NEAR(found[i].distance, expected, 0.5f * std::sqrt(3.0f) * cell) << print(points[i]);
    }
  }
}

TEST_P(MeshSdfs, IsExactNextToFlatFaces) {
  const float half = 0.5f;
  const MeshSdf sdf = build(boxOf({half, half, half}));
  std::vector<Vec3f> points;
  for (Vec3f p : randomPoints(3000, 1)) {
    p.y = half + kBand * p.y;
    p.x *= half - kBand - 2 * kCell;
    p.z *= half - kBand - 2 * kCell;
    points.push_back(p);
  }
  const auto found = query(sdf, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(found[i].distance, points[i].y - half, 1e-6) << print(points[i]);
    ASSERT_NEAR(length(found[i].normal - Vec3f{0, 1, 0}), 0, 1e-4) << print(points[i]);
  }
}

TEST_P(MeshSdfs, SignsAreThoseOfTheSolidWhereSurfacesCross) {
  TriangleMesh mesh;
  append(mesh, icosphere(3, 0.7f), {-0.4f, 0, 0});
  append(mesh, icosphere(3, 0.7f), {0.4f, 0, 0});
  const MeshSdf sdf = build(mesh);
  EXPECT_TRUE(warnings.empty());
  const auto points = randomPoints(3000, 1.3f);
  const auto found = query(sdf, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = slowDistance(mesh, points[i]);
    if (distance < kCell) continue;  // where two surfaces cross, a cell cannot show both
    ASSERT_EQ(found[i].distance<0, slowWindingNumber(mesh, points[i])> 0.5) << print(points[i]);
    if (distance < kBand) {
      ASSERT_NEAR(std::abs(found[i].distance), distance, 0.5 * std::sqrt(3.0) * kCell) << print(points[i]);
    }
  }
}

TEST_P(MeshSdfs, HolesAreClosed) {
  TriangleMesh mesh = icosphere(3);
  const Vec3i hole = mesh.triangles[100];
  mesh.triangles.erase(mesh.triangles.begin() + 100);
  const Vec3f center = (mesh.vertices[hole.x] + mesh.vertices[hole.y] + mesh.vertices[hole.z]) / 3.0f;
  const float size = length(mesh.vertices[hole.x] - center);
  const MeshSdf sdf = build(mesh);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0], "3 open edges");

  const auto points = randomPoints(20000, 1.4f);
  const auto found = query(sdf, points);
  const double facets = icosphereSagitta(icosphere(3));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double expected = length(points[i]) - 1.0;
    if (length(points[i] - center) < 2 * size || std::abs(expected) > kBand) continue;
    ASSERT_NEAR(found[i].distance, expected, facets + interpolationError(kCell, length(points[i])) + 1e-6);
  }
  // Through the hole there is one change from outside to inside, and it is in the hole.
  std::vector<Vec3f> through;
  for (float r = 0.5f; r < 1.4f; r += 0.01f) through.push_back(r * normalized(center));
  const auto along = query(sdf, through);
  for (std::size_t i = 0; i < through.size(); ++i)
    if (std::abs(length(through[i]) - 1) > size) {
      EXPECT_EQ(along[i].distance < 0, length(through[i]) < 1) << length(through[i]);
    }
}

TEST_P(MeshSdfs, AnOpenBowlIsFilledAsItsWindingNumberSays) {
  TriangleMesh bowl = icosphere(3);
  std::erase_if(bowl.triangles, [&](const Vec3i& t) {
    return bowl.vertices[t.x].y + bowl.vertices[t.y].y + bowl.vertices[t.z].y > 0;
  });
  const MeshSdf sdf = build(bowl, kCell, 1);  // no coarse part within one radius
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0], "open shell");
  const auto points = randomPoints(5000, 1);
  const auto found = query(sdf, points);
  int filled = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double winding = slowWindingNumber(bowl, points[i]);
    const bool unclear = std::abs(winding - 0.5) < 0.1 || slowDistance(bowl, points[i]) < 2 * kCell;
    if (unclear) continue;
    ASSERT_EQ(found[i].distance<0, winding> 0.5) << print(points[i]);
    filled += winding > 0.5 ? 1 : 0;
  }
  EXPECT_GT(filled, 500);
}

TEST_P(MeshSdfs, MeshesThatAreInsideOutAreTurned) {
  TriangleMesh mesh = icosphere(2);
  const auto points = randomPoints(1000, 3);
  const auto expected = query(build(mesh), points);
  mesh.flip();
  const auto found = query(build(mesh), points);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0], "inside out");
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_FLOAT_EQ(found[i].distance, expected[i].distance);
}

TEST_P(MeshSdfs, AnOpenSheetIsReportedAndHasDistancesWithoutSign) {
  const TriangleMesh mesh = sheet(5);
  const MeshSdf sdf = build(mesh);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_CONTAINS(warnings[0], "no inside");
  EXPECT_CONTAINS(warnings[1], "20 open edges");
  const auto points = randomPoints(1000, 1);
  const auto found = query(sdf, points);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::abs(points[i].z) < kBand) {
      ASSERT_NEAR(found[i].distance, std::abs(points[i].z), 0.5 * std::sqrt(3.0) * kCell);
    }
}

TEST_P(MeshSdfs, VerticesAtOnePlaceAreNoHolesAndBadTrianglesAreLeftOut) {
  TriangleMesh mesh = unwelded(icosphere(2));
  build(mesh);
  EXPECT_TRUE(warnings.empty());
  mesh.vertices.push_back({NAN, 0, 0});
  const int nan = static_cast<int>(mesh.vertices.size()) - 1;
  mesh.triangles.insert(mesh.triangles.end(), {mesh.triangles[0], {0, 1, nan}, {4, 4, 5}});
  build(mesh);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0], "3 triangles are left out");
}

TEST_P(MeshSdfs, JumpsOnlyBeyondTheBandAndByLessThanStated) {
  const TriangleMesh mesh = icosphere(3, 1.5f);
  const MeshSdf sdf = build(mesh);
  const auto [coarse, fine] = bricks(sdf);
  EXPECT_GT(coarse, 20);
  EXPECT_GT(fine, 20);
  constexpr int kSteps = 4000;
  const auto ends = randomPoints(40, 1.8f);
  for (std::size_t line = 0; line + 1 < ends.size(); line += 2) {
    const Vec3f step = (ends[line + 1] - ends[line]) / static_cast<float>(kSteps);
    std::vector<Vec3f> points;
    for (int i = 0; i <= kSteps; ++i) points.push_back(ends[line] + static_cast<float>(i) * step);
    const auto found = query(sdf, points);
    // Values at the corners of a cell differ by no more than its size, so the slope along each axis is 1.
    const float smooth = std::sqrt(3.0f) * length(step) + 1e-5f;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const float change = std::abs(found[i].distance - found[i - 1].distance);
      const bool inBand = std::abs(length(points[i]) - 1.5f) < kBand - 0.02f;  // the facets are less deep
      const float jump = inBand ? 0 : (MeshSdfView::kBrick + 1) / std::sqrt(2.0f) * kCell;
      ASSERT_LE(change, smooth + jump) << print(points[i]);
    }
  }
}

TEST_P(MeshSdfs, DistancesGrowBeyondTheGrid) {
  const MeshSdf sdf = build(icosphere(3));
  for (const Vec3f& direction : randomPoints(100, 1)) {
    std::vector<Vec3f> points;
    for (float r = 2.8f; r < 1000; r *= 1.1f) points.push_back(r * normalized(direction));
    const auto found = query(sdf, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float expected = length(points[i]) - 1;
      ASSERT_NEAR(found[i].distance, expected, 0.05f * expected) << print(points[i]);
      ASSERT_GT(dot(found[i].normal, normalized(points[i])), 0.95f) << print(points[i]);
      if (i > 0) {
        ASSERT_GT(found[i].distance, found[i - 1].distance) << print(points[i]);
      }
    }
  }
}

TEST_P(MeshSdfs, DistancesGrowBeyondTheGridAboveACave) {
  // Below the wide gap between two slabs the distances are larger than in it: upwards they fall first.
  const float top = 1.34f;
  TriangleMesh cave = boxMesh({-1.4f, -top, -1}, {1.4f, 0.1f - top, 1});
  append(cave, boxMesh({-1.4f, top - 0.1f, -1}, {-0.8f, top, 1}));
  append(cave, boxMesh({0.8f, top - 0.1f, -1}, {1.4f, top, 1}));
  const MeshSdf sdf = build(cave, kCell, 0);
  for (const float x : {-0.5f, -0.2f, 0.0f, 0.02f, 0.3f}) {
    std::vector<Vec3f> points;
    for (float y = top + 0.07f; y < 4; y += 0.01f) points.push_back({x, y, 0});
    const auto found = query(sdf, points);
    for (std::size_t i = 1; i < points.size(); ++i)
      ASSERT_GT(found[i].distance, found[i - 1].distance) << print(points[i]);
  }
}

TEST_P(MeshSdfs, InvertedTurnsInsideOut) {
  const MeshSdf sdf = build(icosphere(2));
  const auto points = randomPoints(1000, 3);
  const auto solid = query(sdf, points, false), container = query(sdf, points, true);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(container[i].distance, -solid[i].distance);
    EXPECT_EQ(container[i].normal, -solid[i].normal);
  }
}

TEST_P(MeshSdfs, APointThatIsNoNumberGetsSomeDistance) {
  const auto found = query(build(icosphere(1)), {{NAN, NAN, NAN}, {0, NAN, 0}});
  for (const SignedDistance& d : found) EXPECT_TRUE(std::isfinite(d.distance));
}

TEST_P(MeshSdfs, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh mesh = icosphere(3);
  const MeshSdf sdf = build(mesh);
  CpuDevice one(1);
  std::vector<std::string> none;
  const MeshSdf other(one, mesh, kCell, kBand, none);
  const MeshSdfView view = sdf.view(false), expected = other.view(false);
  ASSERT_EQ(view.bricks, expected.bricks);
  const int fine = bricks(sdf).second;
  std::vector<float> nodes(static_cast<std::size_t>(fine) * 9 * 9 * 9);
  device->download(nodes.data(), view.nodes, nodes.size() * sizeof(float));
  EXPECT_TRUE(std::equal(nodes.begin(), nodes.end(), expected.nodes));
}

TEST_P(MeshSdfs, RefusesMeshesWithoutTriangles) {
  EXPECT_CONTAINS(errorOf([&] { build({}); }).what(), "no triangles");
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}};
  flat.triangles = {{0, 1, 1}};
  const Error error = errorOf([&] { build(flat); });
  EXPECT_CONTAINS(error.what(), "no triangles");
  EXPECT_EQ(error.kind(), ErrorKind::kScene);
}

TEST_P(MeshSdfs, RefusesGridsThatAreTooLarge) {
  const TriangleMesh mesh = boxOf({0.5f, 0.5f, 0.5f});
  const Error coarse = errorOf([&] { build(mesh, 1e-4f, 1e-3f); });
  EXPECT_EQ(coarse.kind(), ErrorKind::kScene);
  EXPECT_CONTAINS(coarse.message(), "1253 × 1253 × 1253 bricks");
  EXPECT_CONTAINS(coarse.message(), "14.7 GiB");
  EXPECT_CONTAINS(coarse.allowed(), "0.25 GiB");
  EXPECT_CONTAINS(coarse.hint(), "cell_size");
  const Error fine = errorOf([&] { build(mesh, 0.0035f, 1); });
  EXPECT_CONTAINS(fine.message(), "near its surface");
  EXPECT_CONTAINS(fine.allowed(), "at most 2 GiB");
  EXPECT_CONTAINS(fine.hint(), "cell_size");
  EXPECT_EQ(errorOf([&] { build(mesh, 1e-30f, 1); }).kind(), ErrorKind::kScene);
}

TEST_P(MeshSdfs, IsRightAtTheLimitOfPrecision) {
  TriangleMesh mesh;
  const Vec3f far{12000, -12000, 12000};  // floats there are 1/1024 apart, so a cell has 51 of them
  append(mesh, icosphere(3), far);
  const MeshSdf sdf = build(mesh);
  std::vector<Vec3f> points = randomPoints(3000, 1.4f);
  for (Vec3f& p : points) p += far;
  const auto found = query(sdf, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = slowDistance(mesh, points[i]);
    if (distance > kBand) continue;
    ASSERT_NEAR(std::abs(found[i].distance), distance, 0.5 * std::sqrt(3.0) * kCell) << print(points[i]);
    if (distance > kCell) {
      ASSERT_EQ(found[i].distance < 0, length(points[i] - far) < 1) << print(points[i]);
    }
  }
}

TEST_P(MeshSdfs, RefusesMeshesTooFarAwayForTheirCells) {
  TriangleMesh mesh = icosphere(1);
  for (Vec3f& v : mesh.vertices) v.x += 1e6f;
  const Error error = errorOf([&] { build(mesh); });
  EXPECT_CONTAINS(error.message(), "from the origin");
  EXPECT_CONTAINS(error.hint(), "cell_size");
}

WEIR_ON_EVERY_DEVICE(MeshSdfs);

}  // namespace
}  // namespace weir::test
