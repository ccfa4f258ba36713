#include "plugins/bodies/contact_solver.h"

#include <algorithm>
#include <cmath>

#include "plugins/bodies/bullet_shapes.h"
#include "plugins/bodies/known_contacts.h"
#include "plugins/bodies/row_order.h"

namespace weir {

BodyPair ContactSolver::bodiesOf(const BulletRow& of) const {
  return {std::uint32_t(of.m_solverBodyIdA), std::uint32_t(of.m_solverBodyIdB)};
}

ScaledJacobian ContactSolver::jacobianOf(const BulletRow& of) const {
  const BodyPair bodies = bodiesOf(of);
  return {.a = roots_[bodies.a].jacobian(of.m_contactNormal1, of.m_relpos1CrossNormal),
          .b = roots_[bodies.b].jacobian(of.m_contactNormal2, of.m_relpos2CrossNormal)};
}

ImpulseRow ContactSolver::readRow(const BulletRow& of) const {
  ImpulseRow row = makeRow(jacobianOf(of), bodiesOf(of), of.m_cfm / of.m_jacDiagABInv);
  row.target = of.m_rhs / of.m_jacDiagABInv;
  row.lower = of.m_lowerLimit;
  row.upper = of.m_upperLimit;
  return row;
}

const btSolverConstraint& ContactSolver::frictionOf(const BulletRow& contact, int direction) const {
  return m_tmpSolverContactFrictionConstraintPool[contact.m_frictionIndex + direction];
}

FrictionRows ContactSolver::readFriction(std::size_t contact) const {
  const BulletRow& of = m_tmpSolverContactConstraintPool[int(order_[contact])];
  const BulletRow &one = frictionOf(of, 0), &two = frictionOf(of, 1);
  FrictionRows rows = weir::makeFriction({jacobianOf(one), jacobianOf(two)}, bodiesOf(of));
  rows.contact = std::uint32_t(contact);
  rows.friction = one.m_friction;
  rows.target = {one.m_rhs / one.m_jacDiagABInv, two.m_rhs / two.m_jacDiagABInv};
  return rows;
}

std::vector<std::size_t> ContactSolver::orderOfContacts() const {
  const auto moving = [&](int k) {
    return m_tmpSolverBodyPool[k].internalGetInvMass().isZero() ? RowBodies::kFixed : std::size_t(k);
  };
  std::vector<RowBodies> rows;
  for (int k = 0; k < m_tmpSolverContactConstraintPool.size(); ++k) {
    const btSolverConstraint& of = m_tmpSolverContactConstraintPool[k];
    rows.push_back({moving(of.m_solverBodyIdA), moving(of.m_solverBodyIdB)});
  }
  return orderByColor(rows, std::size_t(m_tmpSolverBodyPool.size()));
}

void ContactSolver::readRows() {
  roots_.clear();
  for (int k = 0; k < m_tmpSolverBodyPool.size(); ++k) roots_.emplace_back(m_tmpSolverBodyPool[k]);
  order_ = orderOfContacts();
  rows_.joints.clear(), rows_.contacts.clear(), rows_.frictions.clear();
  rows_.contacts.reserve(order_.size()), rows_.frictions.reserve(order_.size());
  for (int k = 0; k < m_tmpSolverNonContactConstraintPool.size(); ++k)
    rows_.joints.push_back(readRow(m_tmpSolverNonContactConstraintPool[k]));
  for (std::size_t n = 0; n < order_.size(); ++n) {
    rows_.contacts.push_back(readRow(m_tmpSolverContactConstraintPool[int(order_[n])]));
    rows_.frictions.push_back(readFriction(n));
  }
}

void ContactSolver::resolvePenetration(const SweepLimits& end) {
  ImpulseRows corrections;
  corrections.contacts.reserve(order_.size());
  for (std::size_t n = 0; n < order_.size(); ++n) {
    const BulletRow& of = m_tmpSolverContactConstraintPool[int(order_[n])];
    if (of.m_rhsPenetration == 0) continue;
    corrections.contacts.push_back(rows_.contacts[n]);
    corrections.contacts.back().target = of.m_rhsPenetration / of.m_jacDiagABInv;
  }
  if (corrections.contacts.empty()) return;
  VelocityChanges changes(roots_.size(), Vec6d{});
  sweep(corrections, changes, end);
  for (std::size_t k = 0; k < roots_.size(); ++k) {
    btSolverBody& body = m_tmpSolverBodyPool[int(k)];
    body.internalGetPushVelocity() = roots_[k].linear(changes[k]);
    body.internalGetTurnVelocity() = roots_[k].angular(changes[k]);
  }
}

void ContactSolver::warmStart() {
  for (std::size_t n = 0; n < order_.size(); ++n) {
    const BulletRow& of = m_tmpSolverContactConstraintPool[int(order_[n])];
    const Vec3d* known = assignedImpulse(*static_cast<const btManifoldPoint*>(of.m_originalContactPoint));
    if (known == nullptr) continue;
    const auto along = [&](const BulletRow& row) { return dot(*known, fromBullet(row.m_contactNormal1)); };
    FrictionRows& friction = rows_.frictions[n];
    rows_.contacts[n].impulse = std::max(along(of), 0.0);
    friction.impulse = {along(frictionOf(of, 0)), along(frictionOf(of, 1))};
    const double bound = friction.friction * rows_.contacts[n].impulse;
    const double length = std::hypot(friction.impulse[0], friction.impulse[1]);
    if (length > bound)
      for (double& impulse : friction.impulse) impulse *= bound / length;
  }
}

void ContactSolver::solve(const SweepLimits& end) {
  VelocityChanges changes(roots_.size(), Vec6d{});
  applyImpulses(rows_, changes);
  sweep(rows_, changes, end);
  for (std::size_t k = 0; k < roots_.size(); ++k) {
    btSolverBody& body = m_tmpSolverBodyPool[int(k)];
    body.internalGetDeltaLinearVelocity() += roots_[k].linear(changes[k]);
    body.internalGetDeltaAngularVelocity() += roots_[k].angular(changes[k]);
  }
}

void ContactSolver::writeImpulses() {
  for (std::size_t k = 0; k < rows_.joints.size(); ++k)
    m_tmpSolverNonContactConstraintPool[int(k)].m_appliedImpulse = rows_.joints[k].impulse;
  for (std::size_t n = 0; n < order_.size(); ++n) {
    BulletRow& contact = m_tmpSolverContactConstraintPool[int(order_[n])];
    contact.m_appliedImpulse = rows_.contacts[n].impulse;
    for (int direction = 0; direction < 2; ++direction)
      m_tmpSolverContactFrictionConstraintPool[contact.m_frictionIndex + direction].m_appliedImpulse =
          rows_.frictions[n].impulse[std::size_t(direction)];
  }
}

btScalar ContactSolver::solveGroupCacheFriendlyIterations(btCollisionObject**, int, btPersistentManifold**,
                                                          int, btTypedConstraint**, int,
                                                          const btContactSolverInfo& info, btIDebugDraw*) {
  const SweepLimits end{info.m_numIterations, std::sqrt(info.m_leastSquaresResidualThreshold)};
  readRows();
  resolvePenetration(end);
  warmStart();
  solve(end);
  writeImpulses();
  return 0;
}

}  // namespace weir
