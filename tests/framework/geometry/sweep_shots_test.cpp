// Thousands of points that are shot at faces, edges and vertices of meshes, at rest and rotating: none ever
// gets to the other side, as judged by means that share nothing with the sweep.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <random>

#include "framework/compute/dispatch.h"
#include "framework/geometry/mesh_query.h"
#include "framework/geometry/surface_of_revolution.h"
#include "tests/framework/geometry/sweep_kernel.h"
#include "tests/support/devices.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

using SweepShots = OnDevice;

Vec3d wide(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

/// Inside of a convex mesh by its planes, in double.
class ConvexInside {
 public:
  explicit ConvexInside(const TriangleMesh& mesh) {
    for (const Vec3i& t : mesh.triangles) {
      const Vec3d a = wide(mesh.vertices[t.x]);
      const Vec3d n = normalized(cross(wide(mesh.vertices[t.y]) - a, wide(mesh.vertices[t.z]) - a));
      planes_.push_back({a, n});
    }
  }
  bool operator()(const Vec3f& p) const {
    for (const auto& [at, normal] : planes_)
      if (dot(wide(p) - at, normal) > 0) return false;
    return true;
  }

 private:
  struct Plane {
    Vec3d at, normal;
  };
  std::vector<Plane> planes_;
};

struct Setting {
  TriangleMesh mesh;
  std::function<bool(const Vec3f&)> isInside;
  Vec3f center;     // of all that happens
  float reach = 0;  // the points start in a cube of this half size about the centre
  float thickness = 1e-4f;
  float spin = 0;                                      // rad/s, about an axis through the origin
  float rim = std::numeric_limits<float>::infinity();  // height of an opening, which points may pass
  int shots = 10000, steps = 6;
};

/// The points of a setting, moved as a solver does: kept in space, taken to the mesh's frame for each step.
class Shots {
 public:
  Shots(Device& device, const Setting& setting)
      : device_(device),
        setting_(setting),
        query_(setting.mesh),
        tree_(device, setting.mesh),
        clearance_(device, tree_.view(), 0.05f) {
    std::uniform_real_distribution<float> coordinate(-setting.reach, setting.reach);
    const float clear = 1.01f * setting.thickness;
    while (static_cast<int>(points_.size()) < setting.shots) {
      const Vec3f p = setting.center + Vec3f{coordinate(random_), coordinate(random_), coordinate(random_)};
      if (query_.closestDistance(p, clear) >= clear) points_.push_back(p);
    }
    for (const Vec3f& p : points_) inside_.push_back(setting.isInside(p));
  }

  void run() {
    Array<Motion> motions(device_);
    Array<SweepResult> out(device_, setting_.shots);
    for (int step = 0; step < setting_.steps; ++step) {
      // Steps of 1 to 10 ms.
      const float dt =
          1e-3f * std::pow(10.0f, static_cast<float>(step) / static_cast<float>(setting_.steps - 1));
      const Quatf begin = pose(), end = poseAfter(dt);
      std::vector<Motion> asked;
      for (const Vec3f& p : points_) {
        const Vec3f target = aim(rotate(conjugate(begin), p), dt, end, p);
        asked.push_back({rotate(conjugate(begin), p), target, {}});
      }
      motions.assign(asked);
      dispatch(device_, [&](auto& d) {
        sweepAll(d, tree_.view(), clearance_.view(), setting_.thickness, motions.view(), out.view());
      });
      const std::vector<SweepResult> found = out.toHost();
      for (std::size_t i = 0; i < points_.size(); ++i) judge(static_cast<int>(i), asked[i], found[i]);
      for (std::size_t i = 0; i < points_.size(); ++i) points_[i] = rotate(end, found[i].position);
    }
    // Most shots are at the mesh, that many must  have hit it.
    EXPECT_GT(hits_, setting_.shots * setting_.steps / 10);
    EXPECT_EQ(crossed_, 0);
    EXPECT_EQ(tooNear_, 0);
    EXPECT_EQ(tooFar_, 0);
    EXPECT_EQ(strayed_, 0);
    EXPECT_GT(judged_, setting_.shots);
  }

 private:
  Quatf pose() const {
    const float half = 0.5f * angle_;
    const Vec3f axis = normalized(Vec3f{0.3f, 1, -0.2f});
    return {std::cos(half), axis.x * std::sin(half), axis.y * std::sin(half), axis.z * std::sin(half)};
  }
  Quatf poseAfter(float dt) {
    angle_ += setting_.spin * dt;
    return pose();
  }

  /// The end of a step, in the mesh's frame, of a point that flies at 1 to 200 m/s towards a random vertex,
  /// the middle of an edge or a random point of a face. Every eighth ends exactly there.
  Vec3f aim(const Vec3f& local, float dt, const Quatf& end, const Vec3f& p) {
    const Vec3i& t = setting_.mesh.triangles[random_() % setting_.mesh.triangles.size()];
    const Vec3f a = setting_.mesh.vertices[t.x], b = setting_.mesh.vertices[t.y],
                c = setting_.mesh.vertices[t.z];
    std::uniform_real_distribution<float> part(0, 1);
    const float s = part(random_), q = part(random_) * (1 - s);
    const Vec3f targets[] = {a, 0.5f * (a + b), a + s * (b - a) + q * (c - a)};
    const Vec3f target = targets[random_() % 3];
    if (random_() % 8 == 0) return target;
    const float speed = std::pow(200.0f, part(random_));
    if (setting_.spin == 0) return local + speed * dt * normalized(target - local);
    const Vec3f velocity = speed * normalized(rotate(end, target) - p);
    return rotate(conjugate(end), p + dt * velocity);
  }

  void judge(int i, const Motion& motion, const SweepResult& found) {
    hits_ += found.hit;
    const float way = length(motion.to - motion.from);
    tooNear_ += query_.closestDistance(found.position, setting_.thickness) < 0.49f * setting_.thickness;
    tooFar_ += length(found.position - motion.from) > 1.001f * way + 4 * setting_.thickness;
    const bool inside = setting_.isInside(found.position);
    strayed_ += !found.hit && found.position != motion.to;
    const bool mayPassRim = std::abs(motion.from.y - setting_.rim) <= way + 8 * setting_.thickness;
    if (mayPassRim) inside_[i] = inside;
    judged_ += !mayPassRim;
    if (inside_[i] == inside) return;
    ++crossed_;
    inside_[i] = inside;
    const Vec3f from = motion.from, to = motion.to, at = found.position;
    ADD_FAILURE() << "from " << from.x << ", " << from.y << ", " << from.z << " to " << to.x << ", " << to.y
                  << ", " << to.z << " is at " << at.x << ", " << at.y << ", " << at.z;
  }

  Device& device_;
  const Setting& setting_;
  MeshQuery query_;
  TriangleTree tree_;
  ClearanceGrid clearance_;
  std::mt19937 random_{3};
  std::vector<Vec3f> points_;  // in space
  std::vector<bool> inside_;
  float angle_ = 0;
  int hits_ = 0, crossed_ = 0, tooNear_ = 0, tooFar_ = 0, strayed_ = 0, judged_ = 0;
};

Setting sphere(float spin) {
  Setting setting{.mesh = icosphere(2, 0.1f), .reach = 0.15f, .spin = spin};
  setting.isInside = ConvexInside(setting.mesh);
  return setting;
}

Setting box(float spin) {
  Setting setting{.mesh = boxMesh({-0.1f, -0.05f, -0.2f}, {0.1f, 0.15f, 0.1f}), .reach = 0.2f, .spin = spin};
  setting.isInside = ConvexInside(setting.mesh);
  return setting;
}

/// Triangles of 1 to 3 mm, walls of 2 mm.
Setting goblet(float spin) {
  Setting setting{.reach = 0.06f, .spin = spin, .shots = 3000};
  const std::vector<Vec2f> profile = {{0, 0.02f},      {0.02f, 0.025f}, {0.03f, 0.035f},
                                      {0.035f, 0.05f}, {0.034f, 0.07f}, {0.03f, 0.08f}};
  setting.mesh = surfaceOfRevolution(revolutionOutline(profile, {.caps = false, .thickness = 0.002}), 64);
  setting.isInside = [query = MeshQuery(setting.mesh)](const Vec3f& p) {
    return query.windingNumber(p) > 0.5;
  };
  setting.center = {0, 0.05f, 0};
  return setting;
}

/// A single layer that is open at the top. Inside is what is inside once it has a lid.
Setting openGoblet(float spin) {
  Setting setting{.reach = 0.06f, .spin = spin, .rim = 0.08f, .shots = 3000};
  const std::vector<Vec2f> profile = {{0, 0.02f},      {0.02f, 0.025f}, {0.03f, 0.035f},
                                      {0.035f, 0.05f}, {0.034f, 0.07f}, {0.03f, 0.08f}};
  setting.mesh = surfaceOfRevolution(revolutionOutline(profile, {.caps = false}), 64);
  setting.isInside = [query = MeshQuery(surfaceOfRevolution(revolutionOutline(profile, {}), 64))](
                         const Vec3f& p) { return query.windingNumber(p) > 0.5; };
  setting.center = {0, 0.05f, 0};
  return setting;
}

/// Triangles of about 1 cm, 100 m from the origin.
Setting farSphere() {
  Setting setting{.mesh = icosphere(3, 0.1f),
                  .center = {100, -70, 40},
                  .reach = 0.15f,
                  .thickness = 1e-3f,
                  .shots = 3000};
  for (Vec3f& v : setting.mesh.vertices) v += setting.center;
  setting.isInside = ConvexInside(setting.mesh);
  return setting;
}

TEST_P(SweepShots, NoneCrossesASphere) {
  Shots(*device, sphere(0)).run();
}
TEST_P(SweepShots, NoneCrossesARotatingSphere) {
  Shots(*device, sphere(50)).run();
}
TEST_P(SweepShots, NoneCrossesABox) {
  Shots(*device, box(0)).run();
}
TEST_P(SweepShots, NoneCrossesARotatingBox) {
  Shots(*device, box(50)).run();
}
TEST_P(SweepShots, NoneCrossesTheWallsOfAGoblet) {
  Shots(*device, goblet(0)).run();
}
TEST_P(SweepShots, NoneCrossesTheWallsOfARotatingGoblet) {
  Shots(*device, goblet(50)).run();
}
TEST_P(SweepShots, NoneCrossesTheSingleLayerOfAnOpenGoblet) {
  Shots(*device, openGoblet(0)).run();
}
TEST_P(SweepShots, NoneCrossesTheSingleLayerOfARotatingOpenGoblet) {
  Shots(*device, openGoblet(50)).run();
}
TEST_P(SweepShots, NoneCrossesASphereFarFromTheOrigin) {
  Shots(*device, farSphere()).run();
}

WEIR_ON_EVERY_DEVICE(SweepShots);

}  // namespace
}  // namespace weir::test
