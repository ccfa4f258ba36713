// A body as Bullet has it: along its principal axes.
#pragma once

#include <vector>

#include "nodes/body_contacts/body_dynamics.h"
#include "plugins/bodies/bullet_shapes.h"

namespace weir {

class BulletBody {
 public:
  explicit BulletBody(const HeldBody& of);

  btCollisionShape* shape() const { return shape_.shape.get(); }
  const btVector3& inertia() const { return inertia_; }
  /// Of the shape, for a body in that state.
  btTransform transformOf(const BodyState& state) const;
  /// The other way round.
  void setPlace(BodyState& state, const btTransform& shape) const;
  /// Without what is there twice, in the frame of the shape.
  const std::vector<btVector3>& vertices() const { return vertices_; }
  double radius() const { return radius_; }
  /// The least extent of the mesh, m.
  double thickness() const { return thickness_; }
  /// How far from others Bullet knows its contacts, m.
  double apart() const { return apart_; }

 private:
  btMatrix3x3 axes_;  // of the shape, in the frame of the mesh
  btVector3 inertia_;
  BulletShape shape_;
  std::vector<btVector3> vertices_;
  double radius_ = 0, thickness_ = 0, apart_ = 0;
};

}  // namespace weir
