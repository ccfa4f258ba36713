#include "plugins/bodies/contact_solver.h"

#include <algorithm>
#include <cmath>

#include "plugins/bodies/known_contacts.h"
#include "plugins/bodies/row_order.h"

namespace weir {

namespace {

Six sixOf(const btVector3& linear, const btVector3& angular) {
  return {linear.x(), linear.y(), linear.z(), angular.x(), angular.y(), angular.z()};
}

void split(const Six& of, btVector3& linear, btVector3& angular) {
  linear = {of[0], of[1], of[2]};
  angular = {of[3], of[4], of[5]};
}

/// Of an impulse of 1 in that direction.
Six changeOf(const btSolverBody& body, const btVector3& direction, const btVector3& turn) {
  if (body.m_originalBody == nullptr) return {};
  return sixOf(direction * body.internalGetInvMass() * body.m_linearFactor, turn * body.m_angularFactor);
}

}  // namespace

ImpulseRow ContactSolver::rowOf(const btSolverConstraint& of) const {
  const btSolverBody &a = m_tmpSolverBodyPool[of.m_solverBodyIdA],
                     &b = m_tmpSolverBodyPool[of.m_solverBodyIdB];
  return {.directionA = sixOf(of.m_contactNormal1, of.m_relpos1CrossNormal),
          .directionB = sixOf(of.m_contactNormal2, of.m_relpos2CrossNormal),
          .changeA = changeOf(a, of.m_contactNormal1, of.m_angularComponentA),
          .changeB = changeOf(b, of.m_contactNormal2, of.m_angularComponentB),
          .mobility = 1 / of.m_jacDiagABInv,
          .inverse = of.m_jacDiagABInv,
          .wanted = of.m_rhs,
          .softness = of.m_cfm,
          .lower = of.m_lowerLimit,
          .upper = of.m_upperLimit,
          .impulse = of.m_appliedImpulse,
          .a = std::size_t(of.m_solverBodyIdA),
          .b = std::size_t(of.m_solverBodyIdB)};
}

int ContactSolver::firstFriction(std::size_t contact) const {
  return m_tmpSolverContactConstraintPool[int(contact)].m_frictionIndex;
}

std::vector<std::size_t> ContactSolver::orderOfContacts() const {
  const auto moving = [&](int k) {
    return m_tmpSolverBodyPool[k].internalGetInvMass().isZero() ? RowBodies::kStill : std::size_t(k);
  };
  std::vector<RowBodies> rows;
  for (int k = 0; k < m_tmpSolverContactConstraintPool.size(); ++k) {
    const btSolverConstraint& of = m_tmpSolverContactConstraintPool[k];
    rows.push_back({moving(of.m_solverBodyIdA), moving(of.m_solverBodyIdB)});
  }
  return orderApart(rows, std::size_t(m_tmpSolverBodyPool.size()));
}

void ContactSolver::readRows() {
  order_ = orderOfContacts();
  joints_.clear(), contacts_.clear(), frictions_.clear();
  for (int k = 0; k < m_tmpSolverNonContactConstraintPool.size(); ++k)
    joints_.push_back(rowOf(m_tmpSolverNonContactConstraintPool[k]));
  for (const std::size_t k : order_) contacts_.push_back(rowOf(m_tmpSolverContactConstraintPool[int(k)]));
  for (int direction = 0; direction < 2; ++direction)
    for (std::size_t n = 0; n < order_.size(); ++n) {
      const btSolverConstraint& of =
          m_tmpSolverContactFrictionConstraintPool[firstFriction(order_[n]) + direction];
      frictions_.push_back({rowOf(of), of.m_friction, n});
    }
}

void ContactSolver::separate(const SweepsEnd& end) {
  std::vector<ImpulseRow> pushes, none;
  std::vector<FrictionRow> noFrictions;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const btSolverConstraint& of = m_tmpSolverContactConstraintPool[int(order_[k])];
    if (of.m_rhsPenetration == 0) continue;
    pushes.push_back(contacts_[k]);
    pushes.back().wanted = of.m_rhsPenetration;
    pushes.back().impulse = 0;
  }
  if (pushes.empty()) return;
  Changes changes(std::size_t(m_tmpSolverBodyPool.size()), Six{});
  sweep(none, pushes, noFrictions, changes, end);
  for (int k = 0; k < m_tmpSolverBodyPool.size(); ++k) {
    btSolverBody& body = m_tmpSolverBodyPool[k];
    split(changes[std::size_t(k)], body.internalGetPushVelocity(), body.internalGetTurnVelocity());
  }
}

void ContactSolver::guess() {
  for (std::size_t n = 0; n < order_.size(); ++n) {
    const void* of = m_tmpSolverContactConstraintPool[int(order_[n])].m_originalContactPoint;
    const KnownContact* known = knownAs(*static_cast<const btManifoldPoint*>(of));
    if (known == nullptr) continue;
    const auto along = [&](const ImpulseRow& row) {
      const Six& j = row.directionA;
      return dot(known->impulse, Vec3d{j[0], j[1], j[2]});
    };
    contacts_[n].impulse = std::max(along(contacts_[n]), 0.0);
    for (FrictionRow* friction : {&frictions_[n], &frictions_[order_.size() + n]}) {
      const double bound = friction->friction * contacts_[n].impulse;
      friction->row.impulse = std::clamp(along(friction->row), -bound, bound);
    }
  }
}

void ContactSolver::solve(const SweepsEnd& end) {
  Changes changes;
  for (int k = 0; k < m_tmpSolverBodyPool.size(); ++k) {
    btSolverBody& body = m_tmpSolverBodyPool[k];
    changes.push_back(sixOf(body.internalGetDeltaLinearVelocity(), body.internalGetDeltaAngularVelocity()));
  }
  applyImpulses(contacts_, frictions_, changes);
  sweep(joints_, contacts_, frictions_, changes, end);
  for (int k = 0; k < m_tmpSolverBodyPool.size(); ++k) {
    btSolverBody& body = m_tmpSolverBodyPool[k];
    split(changes[std::size_t(k)], body.internalGetDeltaLinearVelocity(),
          body.internalGetDeltaAngularVelocity());
  }
}

void ContactSolver::writeImpulses() {
  for (std::size_t k = 0; k < joints_.size(); ++k)
    m_tmpSolverNonContactConstraintPool[int(k)].m_appliedImpulse = joints_[k].impulse;
  for (std::size_t n = 0; n < order_.size(); ++n) {
    m_tmpSolverContactConstraintPool[int(order_[n])].m_appliedImpulse = contacts_[n].impulse;
    for (int direction = 0; direction < 2; ++direction)
      m_tmpSolverContactFrictionConstraintPool[firstFriction(order_[n]) + direction].m_appliedImpulse =
          frictions_[std::size_t(direction) * order_.size() + n].row.impulse;
  }
}

btScalar ContactSolver::solveGroupCacheFriendlyIterations(btCollisionObject**, int, btPersistentManifold**,
                                                          int, btTypedConstraint**, int,
                                                          const btContactSolverInfo& info, btIDebugDraw*) {
  const SweepsEnd end{info.m_numIterations, std::sqrt(info.m_leastSquaresResidualThreshold)};
  readRows();
  separate(end);
  guess();
  solve(end);
  writeImpulses();
  return 0;
}

}  // namespace weir
