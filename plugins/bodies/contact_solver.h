// Bullet's solver of contacts and joints, with sweeps of ours over the same rows.
#pragma once

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <vector>

#include "plugins/bodies/impulse_rows.h"

namespace weir {

class ContactSolver final : public btSequentialImpulseConstraintSolver {
 protected:
  btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int bodyCount,
                                             btPersistentManifold** manifolds, int manifoldCount,
                                             btTypedConstraint** constraints, int constraintCount,
                                             const btContactSolverInfo& info, btIDebugDraw* drawer) override;

 private:
  ImpulseRow rowOf(const btSolverConstraint& of) const;
  /// Of two that Bullet has for a contact.
  int firstFriction(std::size_t contact) const;
  std::vector<std::size_t> orderOfContacts() const;
  void readRows();
  /// Gives Bullet the impulses that were found.
  void writeImpulses();
  /// Impulses as known contacts had them.
  void guess();
  void solve(const SweepsEnd& end);
  /// Moves bodies out of each other, without changing their velocities.
  void separate(const SweepsEnd& end);

  std::vector<std::size_t> order_;  // of Bullet's contacts
  std::vector<ImpulseRow> joints_, contacts_;
  std::vector<FrictionRow> frictions_;  // of all contacts in the first direction, then in the second
};

}  // namespace weir
