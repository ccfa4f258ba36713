#include "plugins/rendering/gl/surface_pass.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "plugins/rendering/shading/formulas.h"
#include "plugins/views/camera_axes.h"

namespace weir::rendering::gl {
namespace {

Vec3f bytesOf(const Color& color) {
  const Color bytes = inBytes(color);
  return {bytes.r, bytes.g, bytes.b};
}

/// A disc of radius 1 in the plane y = 0, seen from above.
TriangleMesh unitDisc() {
  constexpr int kSides = 128;
  TriangleMesh disc;
  disc.vertices.push_back({});
  for (int i = 0; i < kSides; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * float(i) / kSides;
    disc.vertices.push_back({std::cos(angle), 0, std::sin(angle)});
    disc.triangles.push_back({0, 1 + (i + 1) % kSides, 1 + i});
  }
  return disc;
}

}  // namespace

Eigen::Matrix4f placementOf(const SurfaceView& surface) {
  const Quatf& q = surface.rotation;
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() = Eigen::Quaternionf(q.w, q.x, q.y, q.z).toRotationMatrix();
  matrix.topRightCorner<3, 1>() = toEigen(surface.position);
  return matrix;
}

Aabb placedBounds(const Aabb& bounds, const SurfaceView& surface) {
  Aabb placed;
  if (bounds.empty()) return placed;
  for (const Vec3f& corner : cornersOf(bounds))
    placed.extend(rotate(surface.rotation, corner) + surface.position);
  return placed;
}

void setPlacement(const Program& program, const Camera& camera, const SurfaceView& surface) {
  const Eigen::Matrix4f toView = camera.view * placementOf(surface);
  const Eigen::Matrix3f normalToView = toView.topLeftCorner<3, 3>();
  program.setMatrix4("uToView", toView.data());
  program.setMatrix3("uNormalToView", normalToView.data());
}

SurfacePass::SurfacePass(const Functions& gl)
    : gl_(gl),
      program_(gl, "surface.vert", "surface.frag"),
      groundMesh_(gl),
      disc_(groundMesh_.add(unitDisc())) {}

void SurfacePass::draw(const Frame& frame, const MeshStore& meshes, bool particlesAreThere) {
  program_.use();
  program_.setMatrix4("uToClip", frame.camera.projection().eval().data());
  setGridUniform(program_, frame.width, frame.height);
  const std::vector<SurfaceView>& surfaces = frame.view.surfaces;
  if (!particlesAreThere) {
    setState(gl_, {.depthTest = GL_LEQUAL});
    for (const SurfaceView& surface : surfaces) drawSurface(frame, meshes, surface);
    drawGround(frame, GL_LEQUAL);
    return;
  }
  // What is there stays where both are equally near, so the order is the other way round.
  drawGround(frame, GL_LESS);
  setState(gl_, {.depthTest = GL_LESS});
  for (auto surface = surfaces.rbegin(); surface != surfaces.rend(); ++surface)
    drawSurface(frame, meshes, *surface);
}

void SurfacePass::drawSurface(const Frame& frame, const MeshStore& meshes, const SurfaceView& surface) {
  if (surface.look == SurfaceLook::kGlass || surface.look == SurfaceLook::kWater) return;
  setPlacement(program_, frame.camera, surface);
  program_.set("uColor", bytesOf(surface.color));
  program_.set("uMaterial", surface.look == SurfaceLook::kMetal ? shading::kMetal : shading::kMatt);
  meshes.draw(surface.mesh);
}

void SurfacePass::drawGround(const Frame& frame, GLenum depthTest) {
  const GroundView& ground = frame.view.ground;
  if (!ground.visible) return;
  const Vec3f up = normalized(frame.view.worldUp);
  const Eigen::Matrix3f turn =
      Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitY(), toEigen(up)).toRotationMatrix();
  Eigen::Matrix4f toWorld = Eigen::Matrix4f::Identity();
  toWorld.topLeftCorner<3, 3>() = turn * ground.radius;
  toWorld.topRightCorner<3, 1>() = toEigen(groundMiddle(frame.view));
  const Eigen::Matrix3f normalToView = frame.camera.rotation() * turn;
  program_.setMatrix4("uToView", (frame.camera.view * toWorld).eval().data());
  program_.setMatrix3("uNormalToView", normalToView.data());
  program_.set("uColor", bytesOf(ground.color));
  program_.set("uMaterial", shading::kGround);
  setState(gl_, {.depthTest = depthTest, .culled = GL_BACK});
  groundMesh_.draw(disc_);
}

}  // namespace weir::rendering::gl
