#include "plugins/bodies/bullet_body.h"

#include <algorithm>
#include <set>
#include <tuple>

namespace weir {

namespace {

btQuaternion toBullet(const Quatd& q) {
  return {q.x, q.y, q.z, q.w};
}

}  // namespace

BulletBody::BulletBody(const HeldBody& of) {
  constexpr double kTolerance = 1e-9;
  constexpr int kMaxSteps = 100;
  const Symmetric3& i = of.mass.inertia;
  btMatrix3x3 inertia(i.xx, i.xy, i.zx, i.xy, i.yy, i.yz, i.zx, i.yz, i.zz);
  axes_.setIdentity();
  const double largest = std::max({i.xx, i.yy, i.zz});
  if (std::max({std::abs(i.xy), std::abs(i.yz), std::abs(i.zx)}) > 1e-6 * largest)
    inertia.diagonalize(axes_, kTolerance * largest, kMaxSteps);
  inertia_ = {inertia[0][0], inertia[1][1], inertia[2][2]};
  const btMatrix3x3 back = axes_.transpose();
  const btTransform frame(back, back * -weir::toBullet(of.mass.center));
  shape_ = shapeOfBody(*of.mesh, frame, of.shape == ContactShape::kHull);
  std::set<std::tuple<float, float, float>> seen;
  for (const Vec3f& v : of.mesh->vertices)
    if (seen.emplace(v.x, v.y, v.z).second) vertices_.push_back(frame * btVector3(v.x, v.y, v.z));
  for (const btVector3& v : vertices_) radius_ = std::max(radius_, double(v.length()));
  const Vec3f size = of.mesh->bounds().size();
  thickness_ = std::min({size.x, size.y, size.z});
  apart_ = shape()->getContactBreakingThreshold(gContactBreakingThreshold);
}

btTransform BulletBody::transformOf(const BodyState& state) const {
  return btTransform(btMatrix3x3(toBullet(state.rotation)) * axes_, weir::toBullet(state.center));
}

void BulletBody::setPlace(BodyState& state, const btTransform& shape) const {
  const btMatrix3x3 turned = shape.getBasis() * axes_.transpose();
  btQuaternion q;
  turned.getRotation(q);
  state.center = fromBullet(shape.getOrigin());
  state.rotation = normalized(Quatd{q.w(), q.x(), q.y(), q.z()});
}

}  // namespace weir
