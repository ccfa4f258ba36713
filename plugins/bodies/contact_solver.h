// Bullet's solver of contacts and joints, with sweeps of ours over the same rows.
#pragma once

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <vector>

#include "plugins/bodies/impulse_rows.h"
#include "plugins/bodies/mass_root.h"

namespace weir {

class ContactSolver final : public btSequentialImpulseConstraintSolver {
 protected:
  btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int bodyCount,
                                             btPersistentManifold** manifolds, int manifoldCount,
                                             btTypedConstraint** constraints, int constraintCount,
                                             const btContactSolverInfo& info, btIDebugDraw* drawer) override;

 private:
  using BulletRow = btSolverConstraint;

  BodyPair bodiesOf(const BulletRow& of) const;
  ScaledJacobian jacobianOf(const BulletRow& of) const;
  ImpulseRow readRow(const BulletRow& of) const;
  FrictionRows readFriction(std::size_t contact) const;
  /// Of two that Bullet has for a contact.
  const BulletRow& frictionOf(const BulletRow& contact, int direction) const;
  std::vector<std::size_t> orderOfContacts() const;
  void readRows();
  /// Gives Bullet the impulses that were found.
  void writeImpulses();
  /// Impulses as known contacts had them.
  void warmStart();
  void solve(const SweepLimits& end);
  /// Moves bodies out of each other, without changing their velocities.
  void resolvePenetration(const SweepLimits& end);

  std::vector<MassRoot> roots_;     // of Bullet's bodies
  std::vector<std::size_t> order_;  // of Bullet's contacts
  ImpulseRows rows_;                // a friction for each contact
};

}  // namespace weir
