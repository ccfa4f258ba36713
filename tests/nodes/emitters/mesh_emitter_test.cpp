// Emission from meshes: flux, directions, even spread over the triangles.
#include "nodes/emitters/mesh_emitter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "framework/geometry/surface_points.h"
#include "tests/nodes/emitters/jet.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

TEST(SurfacePoints, AreEvenByAreaAndKeepTheirDistance) {
  // The sheet z = 0, [-1, 1]², in triangles of very different sizes: one half is one quad, the other 2·16².
  TriangleMesh mesh;
  mesh.vertices = {{-1, -1, 0}, {0, -1, 0}, {0, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  TriangleMesh fine = sheet(16);
  for (Vec3f& v : fine.vertices) v.x = 0.5f * (v.x + 1);
  append(mesh, fine);
  const std::size_t count = 1600;  // of 0.05² each
  const SurfacePoints spread = spreadOverSurface(mesh, count, 1);
  ASSERT_EQ(spread.positions.size(), count);
  EXPECT_GT(minDistance(spread.positions), 0.65 * 0.05);
  int left = 0;
  std::vector<int> inSquare(64, 0);  // of 8 x 8, with 25 points each
  for (const Vec3f& p : spread.positions) {
    left += p.x < 0;
    ++inSquare[static_cast<std::size_t>(std::min(7, int((p.x + 1) * 4)) * 8 +
                                        std::min(7, int((p.y + 1) * 4)))];
    EXPECT_FLOAT_EQ(p.z, 0);
  }
  EXPECT_NEAR(left, 800, 12);
  // Random points without elimination would have a variance of 25.
  double variance = 0;
  for (const int n : inSquare) variance += (n - 25) * (n - 25) / 64.0;
  EXPECT_LT(variance, 8.0);
  for (const Vec3f& n : spread.normals) EXPECT_NEAR(std::abs(n.z), 1, 1e-6);
}

TEST(SurfacePoints, TheSeedDecides) {
  const TriangleMesh ball = icosphere(2);
  EXPECT_EQ(spreadOverSurface(ball, 100, 5).positions, spreadOverSurface(ball, 100, 5).positions);
  EXPECT_NE(spreadOverSurface(ball, 100, 5).positions, spreadOverSurface(ball, 100, 6).positions);
}

TEST(MeshEmitter, FluxIsAreaTimesSpeedAndMovesOutwards) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const TriangleMesh ball = icosphere(3, 0.1f);
    Jet<MeshEmitter> jet(*device, 0.01f, object({{"speed", 0.7}}));
    jet.emitFrom(ball);
    const double dt = 3e-3, d = double(0.01f);
    const int steps = 20;
    const std::vector<Vec3f> p = jet.after(dt, steps);
    const double layers = std::ceil(double(0.7f) * dt * steps / d);
    const double inLayer = std::round(ball.area() / (d * d));
    ASSERT_EQ(double(p.size()), layers * inLayer) << name;
    // By the divergence theorem the exact volume is that of the flow through the surface.
    EXPECT_NEAR(double(p.size()) * d * d * d, ball.area() * layers * d, 0.5 * layers * d * d * d);
    const std::vector<Vec3f> v = jet.scene().velocities();
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double travelled = double(0.7f) * dt * steps - d * std::floor(double(k) / inLayer);
      EXPECT_NEAR(length(p[k]), 0.1 + travelled, icosphereSagitta(ball, 0.1) + 1e-4);
      EXPECT_NEAR(length(v[k]), 0.7, 1e-5);
      EXPECT_GT(dot(normalized(p[k]), normalized(v[k])), 0.99);
    }
    EXPECT_GT(minDistance({p.begin(), p.begin() + std::int64_t(inLayer)}), 0.65 * d);
  }
}

TEST(MeshEmitter, RefusesWhatHasNoSurface) {
  const auto device = openDevice("cpu");
  Jet<MeshEmitter> nothing(*device, 0.01f, Value::object());
  nothing.emitFrom({});
  EXPECT_THROW(nothing.after(1e-3, 1), Error);
  TriangleMesh line;
  line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.triangles = {{0, 1, 2}};
  Jet<MeshEmitter> flat(*device, 0.01f, Value::object());
  flat.emitFrom(line);
  EXPECT_THROW(flat.after(1e-3, 1), Error);
  Jet<MeshEmitter> far(*device, 0.01f, Value::object());
  far.emitFrom(boxMesh({1e6f, 0, 0}, {1e6f + 1, 1, 1}));
  EXPECT_THROW(far.after(1e-3, 1), Error);
}

}  // namespace
}  // namespace weir::test
