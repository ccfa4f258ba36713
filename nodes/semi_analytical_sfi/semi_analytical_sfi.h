// Semi-analytical solid-fluid interaction: couples fluids with rigid triangle meshes inside every iteration
// of their solvers (Chang et al. 2020, with exact integrals; see solids/solid_integrals.h).
//
// The fluids are linked to `fluid`, the meshes to `solids`. Each mesh is one solid; all solids of a node
// share its motion
//
//   x(t) = pivot + position(t) + t·velocity + R(t·angular_velocity)·R(rotation(t))·(x_mesh − pivot)
//
// and its parameters. What the fluids do to each solid is reported as force and torque, the torque about the
// moved pivot.
#pragma once

#include <memory>
#include <vector>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/graph/node.h"
#include "framework/solids/solid_coupling.h"

namespace WEIR_API weir {

enum class SolidFill { kAuto, kSolid, kContainer, kSheet };
template <>
struct EnumNames<SolidFill> {
  static constexpr std::array<EnumName, 4> kNames{
      EnumName{"auto",
               "Closed meshes are solid, or containers if they are inside out; open ones are sheets."},
      EnumName{"solid", "The inside of the mesh is solid."},
      EnumName{"container", "The outside of the mesh is solid."},
      EnumName{"sheet", "A thin wall, with room for fluid on both sides."}};
};

enum class WallIntegralForm { kExact, kApproximate };
template <>
struct EnumNames<WallIntegralForm> {
  static constexpr std::array<EnumName, 2> kNames{
      EnumName{"exact", "Exact for any mesh."},
      EnumName{"approximate", "As published by Chang et al. 2020, for comparison: too large near planes."}};
};

/// What fluids do to the solids of one node, in the order of its links.
struct SolidForces {
  static constexpr std::string_view kPortType = "SolidForces";
  struct OfSolid {
    std::string solid;    ///< the node of the mesh
    Vec3d force, torque;  ///< N and N·m, means since the frame before
  };
  std::vector<OfSolid> solids;
};

class SemiAnalyticalSFI final : public Node, public OnRanks, public RigidMotion {
 public:
  static constexpr NodeInfo kInfo{"SemiAnalyticalSFI",
                                  "Couples fluids with rigid triangle meshes, at rest or in motion.",
                                  "moving, stirrer, mixer, paddle, obstacle, solid, collider, wall, "
                                  "container, rigid, body, coupling, ship, force, torque"};
  const NodeInfo& info() const override { return kInfo; }

  Param<SolidFill> fill{*this, "fill", SolidFill::kAuto, {.doc = "Where the matter of the meshes is."}};
  Param<WallIntegralForm> integrals{
      *this, "integrals", WallIntegralForm::kExact, {.doc = "How the kernel is integrated over solids."}};
  Param<float> friction{
      *this,
      "friction",
      0,
      {.min = 0, .softMax = 1, .doc = "Coulomb's coefficient of friction.", .also = "slip, rough"}};
  Param<float> noSlip{*this,
                      "no_slip",
                      0,
                      {.unit = "1/s",
                       .min = 0,
                       .softMax = 1000,
                       .doc = "Rate at which fluid that touches a solid takes its velocity."}};
  Param<float> slip{
      *this,
      "slip",
      0,
      {.min = 0,
       .max = 1,
       .doc = "Of viscous fluid (ViscositySolver) along the surface: 0 sticks to it, 1 is not held at all."}};
  Param<Vec3f> position{
      *this, "position", {}, {.unit = "m", .animated = true, .doc = "Moves the solids from where they are."}};
  Param<Rotation> rotation{
      *this, "rotation", {}, {.unit = "degrees", .animated = true, .doc = "Turns them about the pivot."}};
  Param<Vec3f> velocity{*this, "velocity", {}, {.unit = "m/s", .doc = "Constant velocity, in addition."}};
  Param<Vec3f> angularVelocity{
      *this,
      "angular_velocity",
      {},
      {.unit = "rad/s", .doc = "Constant turning about the pivot, in addition; along its axis."}};
  Param<Vec3f> pivot{*this,
                     "pivot",
                     {},
                     {.unit = "m", .doc = "The point about which the solids turn and torques are counted."}};

  Param<float> simplify{
      *this,
      "simplify",
      0.01f,
      {.unit = "d",
       .min = 0,
       .max = 0.05,
       .doc = "Largest deviation, in particle spacings, of the coarser meshes that take the "
              "place of fine ones; 0 keeps every triangle."}};

  Inputs<Particles> fluid{*this, "fluid", "The fluids that meet the solids.", true};
  Inputs<TriangleMesh> solids{*this, "solids", "The solids' surfaces, in their places at time 0.", true};
  Output<SolidForces> forces{*this, "forces", "What the fluids do to the solids."};

  void configure(const SetupContext& context) override;
  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void reset(const SetupContext& context) override;
  /// Until no point of the solids moved farther than cfl times the smallest spacing of the fluids.
  double longestStep(const StepContext& next, double cfl) override;
  void frame(const StepContext& context) override;
  void report(NodeReport& report) override;
  /// The forces that are put out.
  void save(const StateWriter& to) const override;
  void restore(const StateReader& from) override;

  Pose poseAt(double time) const override;
  Vec3f pivotAt(double time) const override;
  /// A bound of the speed of all points of the solids from `from` to `to`, in s; m/s.
  double maxSpeed(double from, double to) const;

 private:
  SolidKind kindOf(const TriangleMesh& mesh, const std::string& from, Log& log) const;
  TriangleMesh simplifiedMesh(const TriangleMesh& mesh, const std::string& from, float spacing,
                              Log& log) const;

  State<std::vector<std::unique_ptr<Solid>>> parts_{*this, "parts"};
  State<std::int64_t> carved_{*this, "carved"};
  State<double> lastFrame_{*this, "last_frame"};  // s
  double radius_ = 0;                             // of the solids about the pivot, m
};

}  // namespace weir
