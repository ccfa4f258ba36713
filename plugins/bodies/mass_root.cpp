#include "plugins/bodies/mass_root.h"

#include <btBulletDynamicsCommon.h>

#include <cmath>

namespace weir {

namespace {

/// Cholesky's; a pivot of nothing, of an axis that is locked, has a column of zeros.
btMatrix3x3 lowerRootOf(const btMatrix3x3& of) {
  btMatrix3x3 root(0, 0, 0, 0, 0, 0, 0, 0, 0);
  for (int column = 0; column < 3; ++column)
    for (int row = column; row < 3; ++row) {
      btScalar left = of[row][column];
      for (int k = 0; k < column; ++k) left -= root[row][k] * root[column][k];
      if (row == column)
        root[row][column] = left > 0 ? std::sqrt(left) : 0;
      else if (root[column][column] > 0)
        root[row][column] = left / root[column][column];
    }
  return root;
}

}  // namespace

MassRoot::MassRoot(const btSolverBody& body) {
  if (body.m_originalBody == nullptr) return;
  const btVector3 inverse = body.internalGetInvMass() * body.m_linearFactor;
  for (int k = 0; k < 3; ++k) linear_[k] = std::sqrt(inverse[k]);
  btMatrix3x3 turning = body.m_originalBody->getInvInertiaTensorWorld();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      turning[row][column] *= body.m_angularFactor[row] * body.m_angularFactor[column];
  angular_ = lowerRootOf(turning);
}

Vec6d MassRoot::jacobian(const btVector3& linear, const btVector3& angular) const {
  const btVector3 along = linear * linear_, about = angular * angular_;
  return {along.x(), along.y(), along.z(), about.x(), about.y(), about.z()};
}

btVector3 MassRoot::linear(const Vec6d& w) const {
  return btVector3(w[0], w[1], w[2]) * linear_;
}

btVector3 MassRoot::angular(const Vec6d& w) const {
  return angular_ * btVector3(w[3], w[4], w[5]);
}

}  // namespace weir
