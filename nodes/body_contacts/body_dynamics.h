// What holds bodies together and apart: a library's contacts and joints, behind an interface, so that another
// library can take its place. A plugin adds one as a service.
//
// Forces have brought each body from where it was to where it is, `before` to `after`. The library starts
// from the place before with the velocity after, and finds impulses at contacts and joints such that bodies
// do not enter each other or solids, bounce and rub; the body then stands where the changed velocities lead.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/cpu_threads.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/solids/free_body.h"
#include "nodes/rigid_body/body_contact.h"
#include "nodes/static_boundary/boundary.h"

namespace WEIR_API weir {

enum class JointKind { kFixed, kHinge, kSlider, kSpring, kBall };

/// A body as it starts. Mesh and pieces must outlive the library's use of them.
struct HeldBody {
  const TriangleMesh* mesh = nullptr;
  BodyMass mass;
  BodyState start;
  double friction = 0, restitution = 0;
  ContactShape shape = ContactShape::kMesh;
  std::vector<BoundaryPiece> walls;  ///< by signed distance, on the host
};

/// A mesh that bodies do not enter; it must outlive the library's use of it.
struct HeldSolid {
  const TriangleMesh* mesh = nullptr;
  Pose start;
};

/// Of a solid in a step, whatever hits it.
struct SolidMotion {
  Pose begin, end;
};

/// Between bodies a and b, or a and the world where b is -1. All places are those at the start.
struct HeldJoint {
  JointKind kind = JointKind::kFixed;
  int a = -1, b = -1;
  Vec3d anchor, otherAnchor;                      ///< m; the other is the spring's end on b
  Vec3d axis{0, 1, 0};                            ///< of a hinge or a slider, of length 1
  double stiffness = 0, damping = 0, length = 0;  ///< of a spring: N/m, N·s/m, m
  /// Of a hinge or a slider: how far a may turn or move relative to b, from the start; rad or m.
  std::optional<std::array<double, 2>> limits;
};

/// What a joint's motor does in a step.
struct JointDrive {
  std::optional<double> speed;  ///< of a relative to b, about or along the axis; rad/s or m/s
  double effort = 0;            ///< at most, or, without a speed, constantly: N·m or N
};

/// What a contact did in a step, from which the next one starts.
struct KnownContact {
  std::int64_t a = 0, b = 0;  ///< bodies; b is less than 0 for what is none, in a way of the library's own
  Vec3d at;                   ///< on body a, in a frame of its own, m
  Vec3d normal;               ///< towards a
  Vec3d impulse;              ///< on a, N·s
};

class BodyDynamics {
 public:
  static constexpr std::string_view kInterface = "BodyDynamics";
  virtual ~BodyDynamics() = default;

  struct Motion {
    BodyState before, after;
    bool held = false;  ///< whether `after` was changed
  };
  struct Overlap {
    int a = -1, b = -1;  ///< b is -1 for a solid
    double depth = 0;    ///< m
  };

  /// What there is from now on. A body has its own friction and restitution at solids. Returns the deepest
  /// overlap at the start.
  virtual Overlap set(std::vector<HeldBody> bodies, std::vector<HeldSolid> solids,
                      std::vector<HeldJoint> joints) = 0;
  /// Motions in the order of the bodies, solidMotions in that of the solids, drives in that of the joints.
  /// Velocities below `slow` m/s do not bounce. Contacts are those of the last step, of which there are none
  /// at first, and then those of this one. What comes out depends on these arguments and on set() alone, not
  /// on how many threads there are.
  virtual void step(std::vector<Motion>& motions, const std::vector<SolidMotion>& solidMotions,
                    const std::vector<JointDrive>& drives, double dt, double slow,
                    std::vector<KnownContact>& contacts, CpuThreads& threads) = 0;
};

}  // namespace weir
