// Which neighbours a solid hides from each other, against a slow search for what crosses the mesh.
#include "nodes/particle_fluid/hidden_neighbors.h"

#include <gtest/gtest.h>

#include "nodes/particle_fluid/modules/wall_integrals.h"
#include "tests/framework/neighbors/listed_pairs.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.02f, kRatio = 1.5f;

/// At rest, turned and moved.
class Still final : public RigidMotion {
 public:
  Pose poseAt(double) const override { return {Quatf{0.8f, 0.1f, -0.5f, 0.31622777f}, {0.1f, -0.2f, 0.3f}}; }
  Vec3f pivotAt(double) const override { return {}; }
};

double volumeOf(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return dot(b - a, cross(c - a, d - a));
}

/// Where the segment from p to q meets a triangle.
struct Crossing {
  double fraction;
  Vec3d normal;
};

std::vector<Crossing> crossings(const TriangleMesh& mesh, const Vec3d& p, const Vec3d& q) {
  std::vector<Crossing> found;
  for (const Vec3i& t : mesh.triangles) {
    const Vec3d a = toDouble(mesh.vertices[std::size_t(t.x)]), b = toDouble(mesh.vertices[std::size_t(t.y)]),
                c = toDouble(mesh.vertices[std::size_t(t.z)]);
    const double from = volumeOf(p, a, b, c), to = volumeOf(q, a, b, c);
    if (from * to > 0) continue;
    const double u = volumeOf(p, q, a, b), v = volumeOf(p, q, b, c), w = volumeOf(p, q, c, a);
    const Vec3d normal = cross(b - a, c - a);
    if ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))
      found.push_back({from / (from - to), normal / length(normal)});
  }
  return found;
}

struct Case {
  const char* name;
  TriangleMesh mesh;
  SolidKind kind;
  bool anyHidden = true;
};

/// A sheet hides what it cuts; a solid what is in front of and behind it, and not what is round a corner of
/// more than 26°.
bool hides(const Case& of, const Vec3d& p, const Vec3d& q) {
  const std::vector<Crossing> met = crossings(of.mesh, p, q);
  if (of.kind == SolidKind::kSheet) return !met.empty();
  for (const Crossing& in : met)
    for (const Crossing& out : met)
      if (dot(in.normal, q - p) < 0 && dot(out.normal, q - p) > 0 && in.fraction <= out.fraction &&
          dot(in.normal, out.normal) < -0.9)
        return true;
  return false;
}

std::vector<Case> cases() {
  TriangleMesh room = icosphere(2, 0.09f);
  room.flip();
  TriangleMesh bowl = boxMesh({-0.08f, -0.08f, -0.08f}, {0.08f, 0.08f, 0.08f}),
               inner = boxMesh({-0.07f, -0.07f, -0.07f}, {0.07f, 0.07f, 0.07f});
  inner.flip();
  append(bowl, inner);
  TriangleMesh square = sheet(3);
  square.transform(0.07f, {}, {});
  return {{"plate", boxMesh({-0.08f, -0.08f, -0.002f}, {0.08f, 0.08f, 0.002f}), SolidKind::kSolid},
          {"sheet", square, SolidKind::kSheet},
          {"shell", icosphere(1, 0.06f), SolidKind::kSheet},
          {"hollow box", bowl, SolidKind::kSolid},
          {"rod", boxMesh({-0.006f, -0.007f, -0.08f}, {0.006f, 0.007f, 0.08f}), SolidKind::kSolid},
          {"block", boxMesh({-0.05f, -0.05f, -0.05f}, {0.05f, 0.05f, 0.05f}), SolidKind::kSolid, false},
          {"ball", icosphere(2, 0.05f), SolidKind::kSolid, false},
          {"room", room, SolidKind::kContainer, false}};
}

TEST(HiddenNeighbors, AreThosePairsThatAThinPartCuts) {
  for (const std::string& name : availableDevices())
    for (const Case& of : cases()) {
      const auto device = openDevice(name);
      const Still motion;
      const Pose pose = motion.poseAt(0);
      std::vector<Vec3f> positions;
      for (const Vec3f& p : jitteredCube(13, 0.8f * kSpacing, 0.4f, 3, {-0.1f, -0.1f, -0.1f})) {
        const bool outside = std::abs(slowWindingNumber(of.mesh, p)) < 0.5;
        if (of.kind == SolidKind::kSheet || outside == (of.kind == SolidKind::kSolid))
          positions.push_back(pose.toWorld(p));
      }
      ParticleSet particles(*device);
      ParticleBatch batch;
      batch.assign(*device, positions, std::vector<Vec3f>(positions.size()));
      particles.append(batch);
      const FluidConstants constants =
          makeFluidConstants(kSpacing, kRatio, 1000, 1e6f, Calibration::kPacking);
      NeighborList neighbors(*device);
      neighbors.configure(constants.supportRadius, 64);
      const Aabb everywhere{{-9, -9, -9}, {9, 9, 9}};
      neighbors.build(particles, everywhere);
      Solid solid(*device, of.mesh, {.kind = of.kind}, motion, kSpacing);
      WallField walls(*device);
      walls.solids.push_back(&solid);
      walls.place(0, 0);
      Log log([](LogLevel, std::string_view) {});
      const StepContext time{*device, log};
      const std::vector<const Boundary*> none;
      FluidStep step{time, *device, constants, particles, neighbors, none, everywhere, {}, walls};
      WallIntegrals().findWalls(step);

      const Pairs found = listedPairs(particles, neighbors);
      int hidden = 0, pairs = 0;
      for (std::size_t i = 0; i < positions.size(); ++i)
        for (std::size_t j = 0; j < positions.size(); ++j) {
          const Vec3f apart = positions[i] - positions[j];
          if (i == j || dot(apart, apart) >= constants.supportRadius * constants.supportRadius) continue;
          const bool cut =
              hides(of, toDouble(pose.toBody(positions[i])), toDouble(pose.toBody(positions[j])));
          ASSERT_EQ(found.count({int(i), int(j)}), cut ? 0u : 1u) << of.name << " " << i << " " << j;
          hidden += cut;
          ++pairs;
        }
      // In a convex room, and round what is thicker than the support, all see each other.
      if (of.anyHidden)
        EXPECT_GT(hidden, 20) << of.name;
      else
        EXPECT_EQ(hidden, 0) << of.name;
      EXPECT_LT(hidden, pairs / 4) << of.name;
    }
}

}  // namespace
}  // namespace weir::test
