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
  // Where forces move it in a step, is known on the device alone.
  const bool isKnown = body_ == nullptr || dt == 0;
  const Pose end = isKnown ? motion_->poseAt(time + dt) : Pose{};
  return {.tree = tree_.view(),
          .clearance = clearance_.view(),
          .begin = isKnown && dt > 0 ? motion_->poseAt(time) : end,
          .end = end,
          .predicted = end,
          .inverseDt = dt > 0 ? static_cast<float>(1 / dt) : 0.0f,
          .kind = surface_.kind,
          .approximate = surface_.approximate,
          .friction = surface_.friction,
          .carved = carved_->data(),
          .noSlip = surface_.noSlip,
          .slip = surface_.slip,
          .pivot = isKnown ? motion_->pivotAt(time + dt) : Vec3f{},
          .impulse = impulse_->data(),
          .body = body_};
}

}  // namespace weir
