// A rigid triangle mesh that fluids meet: what their kernels see of it, and what it feels of them.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <utility>

#include "framework/base/api.h"
#include "framework/geometry/clearance_grid.h"
#include "framework/graph/param_types.h"
#include "framework/graph/state.h"
#include "framework/solids/free_body.h"

namespace WEIR_API weir {

/// Where the matter of a solid is.
enum class SolidKind { kSolid, kContainer, kSheet };

/// A solid during one step, for kernels.
struct SolidView {
  TriangleTreeView tree;    ///< in the solid's own frame
  ClearanceView clearance;  ///< there, too
  Pose begin, end;          ///< at the beginning and the end of the step
  Pose predicted;           ///< at the end without the fluid's pressure: where particles are stopped at first
  float inverseDt = 0;      ///< 1/s
  SolidKind kind = SolidKind::kSolid;
  bool approximate = false;         ///< the integrals of Chang et al. 2020 in place of exact ones
  float friction = 0;               ///< Coulomb's coefficient
  int* carved = nullptr;            ///< counts the particles that were born where there is no room
  float noSlip = 0;                 ///< 1/s: rate at which fluid in contact takes the solid's velocity
  float slip = 0;                   ///< share of the drag on viscous fluid that is missing
  Vec3f pivot;                      ///< m, at the end of the step: about which torques are counted
  SolidImpulse* impulse = nullptr;  ///< one sum, of all steps
  FreeBody* body = nullptr;         ///< of what forces move

  /// Mean velocity over the step, m/s, of the solid's point that ends at p; of a body that forces move, the
  /// velocity that they have given it so far.
  WEIR_HD Vec3f velocityAt(const Vec3f& p) const {
    if (body != nullptr) return floatOf(body->motion.at(doubleOf(p - pivot)));
    return inverseDt * (p - begin.toWorld(end.toBody(p)));
  }
};

/// What moves a solid.
class RigidMotion {
 public:
  virtual ~RigidMotion() = default;
  virtual Pose poseAt(double time) const = 0;    ///< s
  virtual Vec3f pivotAt(double time) const = 0;  ///< m, the point about which torques are counted
};

struct SolidSurface {
  SolidKind kind = SolidKind::kSolid;
  bool approximate = false;
  float friction = 0;
  float noSlip = 0;  ///< 1/s
  float slip = 0;    ///< share of the drag on viscous fluid that is missing
};

/// Its states are what it counts and sums.
class Solid final : public Stateful {
 public:
  /// The mesh in its own frame; the motion must outlive the solid. `detail` (m, above 0) is the size of what
  /// meets it, such as the spacing of particles; it decides what look-ups cost, but no result.
  Solid(Device& device, const TriangleMesh& mesh, const SolidSurface& surface, const RigidMotion& motion,
        float detail);

  /// Bytes on the device that the solid of such a mesh takes at most, for that detail.
  static double maxMemory(const TriangleMesh& mesh, float detail);

  /// During a step of `dt` seconds; with dt = 0, at rest as it stands at `time`.
  SolidView view(double time, double dt);
  Vec3f pivotAt(double time) const { return motion_->pivotAt(time); }
  const SolidSurface& surface() const { return surface_; }
  /// From now on forces move it: the body, on the device, which must outlive the solid. The motion then says
  /// where it is at frames. `prepare` is called before each step, and whenever the solid is placed.
  void follow(FreeBody& body, std::function<void()> prepare) {
    body_ = &body;
    prepare_ = std::move(prepare);
  }
  bool isMovedByForces() const { return body_ != nullptr; }

  /// One sum, on the device, to which fluids add what they do in each step.
  Array<SolidImpulse>& impulse() { return impulse_; }
  /// Particles that were left out at birth, as this solid left them no room. Waits for the device.
  std::int64_t carvedOnHost() const { return carved_->toHost().front(); }

 private:
  TriangleTree tree_;
  ClearanceGrid clearance_;
  SolidSurface surface_;
  const RigidMotion* motion_;
  FreeBody* body_ = nullptr;
  State<Array<SolidImpulse>> impulse_;
  State<Array<int>> carved_;  // one
  std::function<void()> prepare_;
};

}  // namespace weir
