#include "framework/solids/solid.h"

namespace weir {

namespace {

constexpr float kFinest = 0.5f;  // cells of the clearance grid, in details

}  // namespace

Solid::Solid(Device& device, const TriangleMesh& mesh, const SolidSurface& surface, const RigidMotion& motion,
             float detail)
    : tree_(device, mesh),
      clearance_(device, tree_.view(), kFinest * detail),
      surface_(surface),
      motion_(&motion),
      impulse_(*this, "impulse", Array<SolidImpulse>(device, 1)),
      carved_(*this, "carved", Array<int>(device, 1)) {
  carved_->fillZero();
  impulse_->fillZero();
}

double Solid::maxMemory(const TriangleMesh& mesh, float detail) {
  return TriangleTree::maxMemory(mesh.triangles.size()) +
         ClearanceGrid::maxMemoryFor(mesh.bounds().size(), kFinest * detail);
}

SolidView Solid::view(double time, double dt) {
  if (body_ != nullptr) prepare_();
  // Where a body is, is known on the device.
  const Pose end = body_ != nullptr ? Pose{} : motion_->poseAt(time + dt);
  return {.tree = tree_.view(),
          .clearance = clearance_.view(),
          .begin = dt > 0 && body_ == nullptr ? motion_->poseAt(time) : end,
          .end = end,
          .predicted = end,
          .inverseDt = dt > 0 ? static_cast<float>(1 / dt) : 0.0f,
          .kind = surface_.kind,
          .approximate = surface_.approximate,
          .friction = surface_.friction,
          .carved = carved_->data(),
          .noSlip = surface_.noSlip,
          .slip = surface_.slip,
          .pivot = body_ != nullptr ? Vec3f{} : motion_->pivotAt(time + dt),
          .impulse = impulse_->data(),
          .body = body_};
}

}  // namespace weir
