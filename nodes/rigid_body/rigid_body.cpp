#include "nodes/rigid_body/rigid_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/geometry/simplified_mesh.h"
#include "framework/graph/memory_estimate.h"
#include "framework/particles/flight.h"
#include "nodes/particle_fluid/modules/accelerated_solver.h"
#include "nodes/particle_fluid/modules/semi_implicit_solver.h"
#include "nodes/particle_fluid/modules/solid_approach.h"
#include "nodes/particle_fluid/modules/solid_contact.h"
#include "nodes/particle_fluid/modules/two_projections.h"
#include "nodes/particle_fluid/modules/viscosity_solver.h"
#include "nodes/particle_fluid/modules/wall_integrals.h"
#include "nodes/particle_fluid/particle_fluid.h"

namespace weir {

namespace {

bool isFinite(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Value toValue(const Vec3d& v) {
  return Value::Array{v.x, v.y, v.z};
}

std::int64_t bitsOf(const Param<std::string>& axes, int first) {
  constexpr std::string_view kAxes = "xyz";
  std::int64_t bits = 0;
  for (const char axis : axes.get()) {
    const std::size_t k = kAxes.find(axis);
    if (k == std::string_view::npos || (bits >> (first + int(k)) & 1) != 0)
      throw sceneError("found " + axes.value().brief() + " for axes", R"(some of "xyz", each once)")
          .inParameter(axes.name());
    bits |= std::int64_t{1} << (first + int(k));
  }
  return bits;
}

Symmetric3 scaled(const Symmetric3& s, double by) {
  return {by * s.xx, by * s.yy, by * s.zz, by * s.xy, by * s.yz, by * s.zx};
}

}  // namespace

std::int64_t RigidBody::lockedAxes() const {
  return bitsOf(fixed, 0) | bitsOf(fixedRotation, 3);
}

void RigidBody::validate() const {
  if (density.get().has_value() == mass.get().has_value())
    throw sceneError(density.get() ? "both density and mass are given" : "neither density nor mass is given",
                     "one of them: the other follows from the volume of the mesh");
  lockedAxes();
  if (fluid.size() > 1)
    throw sceneError(fmt::format("{} fluids are linked", fluid.size()), "one fluid for each body");
}

float RigidBody::spacing() const {
  return fluid.empty() ? 0 : fluid[0].material.spacing;
}

void RigidBody::configure(const SetupContext&) {
  for (std::size_t i = 0; i < fluid.size(); ++i) couplingOf(fluid, i);
  fluid.request({static_cast<int>(fluid.size())});
  const ParticleFluid* const in = water();
  if (in == nullptr) return;
  walls.request({in->spacing, 2 * in->spacing});
  checkModules();
}

ParticleFluid* RigidBody::water() const {
  return fluid.empty() ? nullptr : dynamic_cast<ParticleFluid*>(&fluid.links()[0]->node());
}

namespace {

/// The fluid's enabled module of that class, or null.
template <class M>
const M* enabledModule(Node& fluid) {
  for (const auto& module : fluid.pipeline()->modules())
    if (const auto* found = module->enabled() ? dynamic_cast<const M*>(module.get()) : nullptr) return found;
  return nullptr;
}

}  // namespace

void RigidBody::checkModules() const {
  ParticleFluid& in = *water();
  const auto refuse = [&](std::string_view found, std::string_view allowed) {
    throw sceneError(fmt::format("node '{}', in which the body is, {}", in.name(), found),
                     std::string(allowed));
  };
  const auto* accelerated = enabledModule<AcceleratedSolver>(in);
  if (enabledModule<SemiImplicitSolver>(in) == nullptr && enabledModule<TwoProjections>(in) == nullptr &&
      accelerated == nullptr)
    refuse("has no solver that moves bodies", "a SemiImplicitSolver, an AcceleratedSolver or TwoProjections");
  if (accelerated != nullptr && accelerated->acceleration == Acceleration::kConjugate)
    refuse("has an AcceleratedSolver whose conjugate gradients do not move bodies",
           R"("acceleration": "nesterov" or "none")");
  if (enabledModule<SolidApproach>(in) == nullptr || enabledModule<WallIntegrals>(in) == nullptr ||
      enabledModule<SolidContact>(in) == nullptr)
    refuse("does not meet it in full", "enabled modules SolidApproach, WallIntegrals and SolidContact");
  if (enabledModule<ViscositySolver>(in) != nullptr && slip < 1)
    refuse("has a ViscositySolver, which does not drag bodies yet",
           R"("slip": 1 of the body, or Xsph in place of the ViscositySolver)");
}

void RigidBody::warnOfWalls(Log& log) const {
  const auto holds = [&](const OutputPort* boundary) {
    return std::find(walls.links().begin(), walls.links().end(), boundary) != walls.links().end();
  };
  for (const OutputPort* boundary : water()->boundaries.links())
    if (!holds(boundary))
      log.warn(
          fmt::format("node '{0}': '{1}' holds the fluid but not the body, which passes through it; the link "
                      "{1}.{2} -> {0}.{3} makes it hold both",
                      name(), boundary->node().name(), boundary->name(), walls.name()));
}

bool RigidBody::isHeld() const {
  for (const InputPort* reader : body.links())
    if (reader->many()) return true;  // a joint takes one
  return false;
}

bool RigidBody::isHeldWith(const OutputPort& meshOrBody) const {
  for (const InputPort* reader : body.links())
    for (const InputPort* input : reader->node().inputs())
      if (reader->many() && input->many() &&
          std::find(input->links().begin(), input->links().end(), &meshOrBody) != input->links().end())
        return true;
  return false;
}

bool RigidBody::leaveMoving(const Node& to) {
  if (mover_ == nullptr) mover_ = &to;
  return mover_ == &to;
}

void RigidBody::place(const BodyState& to) {
  known_.reset();
  FreeBody moved = body_->toHost().front();
  moved.state = to;
  moved.motion = twistOf(moved.mass, to);
  body_->assign(std::vector<FreeBody>{moved});
}

void RigidBody::placeMesh(const Quatd& turn, const Vec3d& translation, const Twist& motion) {
  const double length = std::sqrt(turn.w * turn.w + turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
  if (!isFinite(translation) || !isFinite(motion.linear) || !isFinite(motion.angular) ||
      !(std::abs(length - 1) < 1e-3))
    throw usageError("found a place or a velocity that is not finite, or a rotation that is none",
                     "finite numbers, and a quaternion w, x, y, z of length 1")
        .inNode(name());
  BodyState to;
  to.rotation = normalized(turn);
  to.center = translation + rotate(to.rotation, start_.mass.center);
  setMotion(to, start_.mass, motion);
  place(to);
  shown_ = earlier_ = to;
}

void RigidBody::setMotion(BodyState& of, const BodyMass& mass, const Twist& motion) {
  const SolidImpulse allowed = mass.taken({motion.linear, motion.angular});
  of.velocity = allowed.linear;
  of.spin = mass.taken({{}, product(mass.matrix(of.rotation), {{}, allowed.angular}).angular}).angular;
}

void RigidBody::findOthers() {
  others_.clear();
  surface_.reset();
  for (const InputPort* reader : fluid.links()[0]->links()) {
    const Node& node = reader->node();
    if (&node == this || dynamic_cast<const RigidMotion*>(&node) == nullptr) continue;
    const auto* other = dynamic_cast<const RigidBody*>(&node);
    if (other != nullptr && isHeldWith(other->body)) continue;
    for (const InputPort* input : node.inputs())
      if (input->typeName() == mesh.typeName())
        for (const OutputPort* shape : input->links())
          if (other != nullptr || !isHeldWith(*shape))
            others_.push_back(
                {&node, std::make_unique<CrossingMesh>(*static_cast<const Output<TriangleMesh>&>(*shape))});
  }
  if (!others_.empty()) surface_ = std::make_unique<CrossingMesh>(*mesh);
}

void RigidBody::checkOthers(double time) const {
  const Pose here = poseOf(start_.mass, shown_);
  for (const Other& other : others_) {
    // Another body may not know yet where it is at this frame.
    const auto* free = dynamic_cast<const RigidBody*>(other.node);
    const Pose there = free != nullptr ? poseOf(free->start_.mass, free->state())
                                       : dynamic_cast<const RigidMotion&>(*other.node).poseAt(time);
    if (!surface_->crosses(here, *other.mesh, there)) continue;
    const std::string found =
        fmt::format("the body has met '{}' at {:.3g} s, which does not hold it", other.node->name(), time);
    const std::string allowed = "bodies that stay apart from each other and from solids given by meshes";
    const std::string hint = "link both to a BodyContacts, or hold the body by \"fixed\"";
    throw time > 0 ? simulationError(found, allowed, hint) : sceneError(found, allowed, hint);
  }
}

void RigidBody::estimate(const SetupContext&, MemoryNeeds& needs) {
  needs.add(BodyContact::memoryFor(double(mesh->vertices.size())));
  if (fluid.empty()) return;
  needs.add(Solid::maxMemory(*mesh, spacing()));
  needs.add(bytesOfArray(fluid[0].maxCount, 2 * sizeof(float)));  // WallField::lift and grip
}

void RigidBody::checkMesh(const TriangleMesh& shape) const {
  const std::string from = mesh.links().front()->node().name();
  const MeshDiagnosis diagnosis = diagnose(shape);
  if (!diagnosis.closed() || diagnosis.inconsistentEdges > 0 || diagnosis.nonFiniteVertices > 0)
    throw sceneError(
        fmt::format("the mesh of {} triangles from '{}' has {}, so what it encloses is not certain",
                    shape.triangles.size(), from, shape.empty() ? "no triangles" : diagnosis.message()),
        "a closed mesh whose triangles all face outwards");
  if (shape.empty() || diagnosis.insideOut)
    throw sceneError(fmt::format("the mesh of {} triangles from '{}' {}", shape.triangles.size(), from,
                                 shape.empty() ? "is empty" : "is inside out"),
                     "a closed mesh whose triangles all face outwards");
}

BodyMass RigidBody::massOfMesh(const TriangleMesh& shape) const {
  const MassProperties of = massProperties(shape);
  const Vec3f size = shape.bounds().size();
  constexpr double kThinnest = 1e-9;  // of the box around the mesh
  if (!(of.volume > kThinnest * double(length(size)) * length(size) * length(size)))
    throw sceneError(fmt::format("the mesh from '{}' encloses a volume of {:.3g} m³",
                                 mesh.links().front()->node().name(), of.volume),
                     "a mesh that encloses matter");
  const double each = density.get() ? *density.get() : *mass.get() / of.volume;
  return {.mass = each * of.volume,
          .center = of.center,
          .inertia = scaled(of.inertia, each),
          .locked = lockedAxes()};
}

BodyState RigidBody::stateAtStart(const BodyMass& of) const {
  const Quatf turned = rotation->toQuaternion();
  BodyState state;
  state.center = of.center + doubleOf(position);
  state.rotation = normalized(Quatd{turned.w, turned.x, turned.y, turned.z});
  setMotion(state, of, {doubleOf(velocity), doubleOf(angularVelocity)});
  return state;
}

void RigidBody::checkPlace() const {
  if (fluid.empty()) return;
  const ParticleFluid* const in = water();
  if (in == nullptr) return;
  const Pose at = poseOf(start_.mass, start_.state);
  Aabb box;
  for (const Vec3f& vertex : mesh->vertices) box.extend(at.toWorld(vertex));
  const auto outside = [&](int axis) {
    return (in->domainMin.get() && box.hi[axis] < (*in->domainMin.get())[axis]) ||
           (in->domainMax.get() && box.lo[axis] > (*in->domainMax.get())[axis]);
  };
  for (int axis = 0; axis < 3; ++axis)
    if (outside(axis))
      throw sceneError(
          fmt::format("the body starts outside the domain of '{}': it is between {:.3g} and {:.3g} m "
                      "along {}",
                      in->name(), box.lo[axis], box.hi[axis], "xyz"[axis]),
          "a position within domain_min and domain_max")
          .inParameter(position.name());
}

void RigidBody::reset(const SetupContext& context) {
  for (std::size_t i = 0; i < fluid.size(); ++i)
    if (fluid[i].period.any())
      throw sceneError("a body does not pass the faces of a periodic domain yet",
                       "a fluid with \"periodic\": \"none\"");
  parts_->clear();
  forces->solids.clear();
  carved_ = 0;
  lastFrame_ = 0;
  const TriangleMesh& shape = *mesh;
  checkMesh(shape);
  start_ = {};
  start_.mass = massOfMesh(shape);
  start_.state = start_.predicted = stateAtStart(start_.mass);
  start_.motion = twistOf(start_.mass, start_.state);
  shown_ = earlier_ = start_.state;
  told_ = {};
  mover_ = nullptr;
  known_.reset();
  shownTime_ = 0;
  checkPlace();
  radius_ = 0;
  for (const Vec3f& vertex : shape.vertices)
    radius_ = std::max(radius_, length(doubleOf(vertex) - start_.mass.center));
  *body_ = Array<FreeBody>(context.device, std::vector<FreeBody>{start_});
  std::vector<const Boundary*> boundaries;
  for (std::size_t i = 0; i < walls.size(); ++i) boundaries.push_back(&walls[i]);
  contact_.reset(context.device, shape, boundaries, {wallFriction, restitution});
  const double depth = contact_.depthOf(start_.mass, start_.state), most = 0.01 * radius_;
  if (depth > most)
    throw sceneError(fmt::format("the body starts {:.3g} m deep within its walls", depth),
                     fmt::format("a position at most {:.1g} m within them", most))
        .inParameter(position.name());
  if (!fluid.empty()) meetFluid(context, shape);
}

void RigidBody::meetFluid(const SetupContext& context, const TriangleMesh& shape) {
  constexpr double kDeviation = 0.01;  // spacings
  const std::string from = mesh.links().front()->node().name();
  const SolidSurface surface{.kind = SolidKind::kSolid, .friction = friction, .noSlip = noSlip, .slip = slip};
  parts_->push_back(std::make_unique<Solid>(
      context.device, simplified(shape, kDeviation * double(spacing())).mesh, surface, *this, spacing()));
  parts_->front()->follow(*body_->data(), [this] { tellApplied(); });
  forces->solids.push_back({from, {}, {}});
  findOthers();
  if (water() != nullptr) warnOfWalls(context.log);
  carved_ = couplingOf(fluid, 0).accept(parts_.get());
  if (carved_ > 0)
    context.log.info(
        fmt::format("node '{}': {} of the particles of '{}' start inside the body and are left out", name(),
                    carved_.get(), fluid.links()[0]->node().name()));
}

double RigidBody::longestStep(const StepContext& next, double cfl) {
  if (fluid.empty()) return Node::longestStep(next, cfl);
  const BodyState now = state();
  const Twist motion = twistOf(start_.mass, now);
  return timeToFly(cfl * double(spacing()), length(motion.linear) + radius_ * length(motion.angular),
                   length(next.gravity));
}

void RigidBody::tellApplied() {
  const AppliedForce now{doubleOf(appliedForce), doubleOf(appliedTorque)};
  if (now == told_) return;
  told_ = now;
  body_->device().upload(&body_->data()->applied, &now, sizeof now);
}

void RigidBody::step(const StepContext& context) {
  tellApplied();
  known_.reset();
  if (mover_ != nullptr) return;
  contact_.step(*body_, context.gravity, context.dt, /*holds=*/!isHeld());
}

void RigidBody::frame(const StepContext& context) {
  if (context.time > shownTime_) earlier_ = shown_;
  shown_ = state();
  shownTime_ = context.time;
  checkState(context.time);
  if (!others_.empty()) checkOthers(context.time);
  const double elapsed = context.time - lastFrame_;
  if (!(elapsed > 0) || parts_->empty()) return;
  lastFrame_ = context.time;
  Array<SolidImpulse>& impulse = parts_.get().front()->impulse();
  const SolidImpulse sum = impulse.toHost().front();
  impulse.fillZero();
  forces->solids.front().force = sum.linear / elapsed;
  forces->solids.front().torque = sum.angular / elapsed;
}

void RigidBody::checkState(double time) const {
  const Quatd& q = shown_.rotation;
  if (isFinite(shown_.center) && isFinite(shown_.velocity) && isFinite(shown_.spin) &&
      std::isfinite(q.w + q.x + q.y + q.z))
    return;
  throw simulationError(fmt::format("the body's place or velocity is no number at {:.3g} s", time), {},
                        "use a smaller world.dt, or more solver iterations");
}

void RigidBody::save(const StateWriter& to) const {
  if (forces->solids.empty()) return;
  to.in("forces").put("force", forces->solids.front().force);
  to.in("forces").put("torque", forces->solids.front().torque);
}

void RigidBody::restore(const StateReader& from) {
  known_.reset();
  shown_ = earlier_ = state();
  shownTime_ = lastFrame_;
  told_ = body_->toHost().front().applied;
  if (forces->solids.empty()) return;
  from.in("forces").get("force", forces->solids.front().force);
  from.in("forces").get("torque", forces->solids.front().torque);
}

BodyState RigidBody::shownAt(double time) const {
  if (time > shownTime_) return state();
  if (!(time > 0) && shownTime_ > 0) return start_.state;
  return time < shownTime_ ? earlier_ : shown_;
}

Pose RigidBody::poseAt(double time) const {
  return poseOf(start_.mass, shownAt(time));
}

Vec3f RigidBody::pivotAt(double time) const {
  return floatOf(shownAt(time).center);
}

void RigidBody::report(NodeReport& report) {
  if (body_->size() == 0) return;
  const BodyState now = state();
  Value& v = report.statistics;
  v["mass"] = start_.mass.mass;
  v["position"] = toValue(now.center);
  v["rotation"] = Value::Array{now.rotation.w, now.rotation.x, now.rotation.y, now.rotation.z};
  v["velocity"] = toValue(now.velocity);
  v["angular_velocity"] = toValue(twistOf(start_.mass, now).angular);
  if (forces->solids.empty()) return;
  v["force"] = toValue(forces->solids.front().force);
  v["torque"] = toValue(forces->solids.front().torque);
  const std::int64_t atBirth = parts_.get().front()->carvedOnHost();
  v["particles_carved"] = carved_ + atBirth;
  report.events.push_back({"particles of emitters were born inside bodies and left out", atBirth});
}

}  // namespace weir
