// A rigid body that water and gravity move: it floats, sinks, drifts and turns.
//
// What the mesh encloses is filled evenly; mass, centre of mass and inertia are those of mass_properties.h.
// The fluid moves the body within the iterations of its solver (nodes/particle_fluid/body_coupling.h), so
// that bodies of any density are stable at the fluid's own time step. Between forces it moves as free_body.h
// says.
//
// Boundaries that are linked to `walls` hold the vertices of the mesh: where the body would reach into one at
// the end of a step, impulses at these vertices change its velocity so that it does not, with Coulomb's
// friction and a restitution. By themselves bodies do not hold each other, nor do solids given by meshes:
// where one meets another, the run ends with an error, unless a BodyContacts takes both. That holds the body
// at its walls, too. What the fluid's modules cannot do with a body is refused before.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/graph/node.h"
#include "framework/solids/mesh_crossing.h"
#include "framework/solids/solid_coupling.h"
#include "nodes/rigid_body/body_contact.h"
#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"
#include "nodes/static_boundary/boundary.h"

namespace WEIR_API weir {

class ParticleFluid;
class RigidBody;

template <>
struct EnumNames<ContactShape> {
  static constexpr std::array<EnumName, 2> kNames{
      EnumName{"mesh", "Its mesh."},
      EnumName{"hull", "About its convex hull, of some 40 points, which is faster; hollows are filled."}};
};

/// A body, as what holds it with others takes it.
struct BodyLink {
  static constexpr std::string_view kPortType = "RigidBody";
  RigidBody* body = nullptr;
};

class RigidBody final : public Node, public OnRanks, public RigidMotion {
 public:
  static constexpr NodeInfo kInfo{
      "RigidBody", "A rigid body that water and gravity move.",
      "float, floating, sink, buoyancy, boat, ship, raft, box, crate, ball, wood, "
      "dynamic, buoy"};
  const NodeInfo& info() const override { return kInfo; }

  RigidBody() { body->body = this; }

  Param<std::optional<double>> density{
      *this,
      "density",
      std::nullopt,
      {.unit = "kg/m^3", .min = 0, .aboveMin = true, .doc = "Of the body. Either this or mass."}};
  Param<std::optional<double>> mass{
      *this, "mass", std::nullopt, {.unit = "kg", .min = 0, .aboveMin = true, .doc = "In place of density."}};
  Param<Vec3f> position{*this, "position", {}, {.unit = "m", .doc = "Moves the mesh to its start."}};
  Param<Rotation> rotation{
      *this, "rotation", {}, {.unit = "degrees", .doc = "Turns it there, about its centre of mass."}};
  Param<Vec3f> velocity{
      *this, "velocity", {}, {.unit = "m/s", .doc = "That of the centre of mass at the start."}};
  Param<Vec3f> angularVelocity{
      *this, "angular_velocity", {}, {.unit = "rad/s", .doc = "At the start; along its axis."}};
  Param<std::string> fixed{
      *this, "fixed", "", {.doc = "Axes of the world along which it does not move, such as \"xz\"."}};
  Param<std::string> fixedRotation{
      *this, "fixed_rotation", "", {.doc = "Axes of the world about which it does not turn: \"xyz\"."}};
  Param<float> friction{
      *this, "friction", 0, {.min = 0, .softMax = 1, .doc = "Of fluid along it; Coulomb's coefficient."}};
  Param<float> noSlip{*this,
                      "no_slip",
                      0,
                      {.unit = "1/s",
                       .min = 0,
                       .softMax = 1000,
                       .doc = "Rate at which fluid that touches the body takes its velocity."}};
  Param<float> slip{
      *this,
      "slip",
      0,
      {.min = 0, .max = 1, .doc = "Of viscous fluid (ViscositySolver) along it, which takes 1 so far."}};
  Param<float> wallFriction{
      *this,
      "wall_friction",
      0.3f,
      {.min = 0, .softMax = 1, .doc = "Coulomb's, of the body at walls and other bodies."}};
  Param<float> restitution{
      *this,
      "restitution",
      0.2f,
      {.min = 0, .max = 1, .doc = "Share of its speed with which it bounces off its walls."}};

  Param<ContactShape> contactShape{*this,
                                   "contact_shape",
                                   ContactShape::kMesh,
                                   {.doc = "What of it other bodies and solids touch, by BodyContacts."}};
  Param<Vec3f> appliedForce{*this,
                            "applied_force",
                            {},
                            {.unit = "N",
                             .live = true,
                             .animated = true,
                             .doc = "A force on its centre of mass, besides those of fluids.",
                             .also = "thrust, propeller, push, pull, control, actuator"}};
  Param<Vec3f> appliedTorque{
      *this,
      "applied_torque",
      {},
      {.unit = "N*m", .live = true, .animated = true, .doc = "A torque, besides those of fluids."}};

  Inputs<Particles> fluid{*this, "fluid", "The fluid that moves it."};
  Input<TriangleMesh> mesh{*this, "mesh", "Its surface: closed, facing outwards."};
  Inputs<Boundary> walls{*this, "walls", "Boundaries that it does not enter."};
  Output<SolidForces> forces{*this, "forces", "What the fluid does to it, about its centre of mass."};
  Output<BodyLink> body{*this, "body", "For BodyContacts, and joints."};

  void validate() const override;
  void configure(const SetupContext& context) override;
  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void reset(const SetupContext& context) override;
  /// Until no point of it moved farther than cfl times the fluid's spacing.
  double longestStep(const StepContext& next, double cfl) override;
  void step(const StepContext& context) override;
  void frame(const StepContext& context) override;
  void report(NodeReport& report) override;
  /// The forces that are put out.
  void save(const StateWriter& to) const override;
  void restore(const StateReader& from) override;

  /// At the last frame; for earlier times at the one before, as far as that is known; for later ones as it is
  /// now, for which it waits for the device; at time 0, at the start.
  Pose poseAt(double time) const override;
  /// The centre of mass.
  Vec3f pivotAt(double time) const override;

  /// From its reset on.
  const BodyMass& massOf() const { return start_.mass; }
  /// As it is now. Waits for the device.
  BodyState state() const { return known_ ? *known_ : body_->toHost().front().state; }
  /// For what holds many bodies, in its reset: from then on that moves the body on at the end of each step,
  /// in place of the body itself. Returns false if another one does so.
  bool leaveMoving(const Node& to);
  /// The body on the device.
  FreeBody* onDevice() { return body_->data(); }
  /// What it has been brought to on the device, until the next step.
  void tellState(const BodyState& now) { known_ = now; }
  /// Between steps.
  void place(const BodyState& to);
  /// The same by a user, who puts its mesh there and gives it velocities, in m/s and rad/s. What is fixed of
  /// them stays 0. Throws a usage Error if a number is not finite, or the rotation is none.
  void placeMesh(const Quatd& turn, const Vec3d& translation, const Twist& motion);
  /// Of the mesh about the centre of mass, m.
  double radius() const { return radius_; }

 private:
  BodyMass massOfMesh(const TriangleMesh& shape) const;
  /// Throws a scene Error if the mesh encloses nothing, or nothing that is certain.
  void checkMesh(const TriangleMesh& shape) const;
  BodyState stateAtStart(const BodyMass& mass) const;
  /// Without what is locked.
  static void setMotion(BodyState& of, const BodyMass& mass, const Twist& motion);
  /// Throws a scene Error if the body starts outside the fluid's domain or in a wall.
  void checkPlace() const;
  void meetFluid(const SetupContext& context, const TriangleMesh& shape);
  /// Null without one.
  ParticleFluid* water() const;
  /// Throws a scene Error if modules of the fluid cannot move a body, or it without them.
  void checkModules() const;
  /// Warns of boundaries of the fluid that do not hold the body.
  void warnOfWalls(Log& log) const;
  /// What BodyContacts do with it.
  bool isHeld() const;
  bool isHeldWith(const OutputPort& meshOrBody) const;
  /// The other solids in the same fluid that nothing holds apart from it.
  void findOthers();
  /// Throws an Error if the body is nowhere.
  void checkState(double time) const;
  /// Throws an Error if it has met one of them.
  void checkOthers(double time) const;
  std::int64_t lockedAxes() const;
  BodyState shownAt(double time) const;
  /// Brings what is applied to the body, if it has changed.
  void tellApplied();
  float spacing() const;

  State<Array<FreeBody>> body_{*this, "body"};                        // one
  State<std::vector<std::unique_ptr<Solid>>> parts_{*this, "parts"};  // one, where there is a fluid
  State<std::int64_t> carved_{*this, "carved"};
  State<double> lastFrame_{*this, "last_frame"};  // s
  BodyContact contact_;
  FreeBody start_;
  /// A mesh of another solid in the same fluid, and the node that moves it.
  struct Other {
    const Node* node;
    std::unique_ptr<CrossingMesh> mesh;
  };
  std::unique_ptr<CrossingMesh> surface_;
  std::vector<Other> others_;
  const Node* mover_ = nullptr;     // what moves it on, if not itself
  std::optional<BodyState> known_;  // its state on the device, where that is known
  AppliedForce told_;               // what the body on the device has
  BodyState shown_, earlier_;       // at the last frame and the one before
  double shownTime_ = 0;            // s
  double radius_ = 0;               // of the mesh about the centre of mass, m
};

}  // namespace weir
