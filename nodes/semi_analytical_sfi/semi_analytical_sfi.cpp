#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "framework/base/turn.h"
#include "framework/base/vec_value.h"
#include "framework/geometry/simplified_mesh.h"
#include "framework/graph/memory_estimate.h"
#include "framework/particles/flight.h"

namespace weir {

namespace {

Eigen::Quaternionf toEigen(const Quatf& q) {
  return {q.w, q.x, q.y, q.z};
}

}  // namespace

Pose SemiAnalyticalSFI::poseAt(double time) const {
  const Vec3f spin = angularVelocity;
  const double rate = std::hypot(spin.x, spin.y, spin.z);
  Eigen::Quaternionf turned = toEigen(rotation.at(time).toQuaternion());
  if (rate > 0) {
    // In double, because a long run turns many times.
    const Eigen::Vector3d axis = Eigen::Vector3d(spin.x, spin.y, spin.z) / rate;
    turned = Eigen::Quaterniond(Eigen::AngleAxisd(rate * time, axis)).cast<float>() * turned;
    turned.normalize();
  }
  const Quatf q{turned.w(), turned.x(), turned.y(), turned.z()};
  return {q, pivotAt(time) - rotate(q, pivot)};
}

Vec3f SemiAnalyticalSFI::pivotAt(double time) const {
  return pivot.get() + position.at(time) + static_cast<float>(time) * velocity.get();
}

double SemiAnalyticalSFI::maxSpeed(double from, double to) const {
  constexpr double kRadians = std::numbers::pi / 180;
  const auto apart = [](const Vec3f& a, const Vec3f& b) { return double(length(b - a)); };
  // Three turns one after another: their rates add at most.
  const auto turned = [](const Rotation& a, const Rotation& b) {
    if (a.quaternion || b.quaternion) return shortestAngle(a.toQuaternion(), b.toQuaternion());
    const Vec3f by = b.degrees - a.degrees;
    return kRadians * (std::abs(double(by.x)) + std::abs(double(by.y)) + std::abs(double(by.z)));
  };
  const double spin = length(angularVelocity.get()) + rotation.fastest(from, to, turned);
  return length(velocity.get()) + position.fastest(from, to, apart) + spin * radius_;
}

double SemiAnalyticalSFI::longestStep(const StepContext& next, double cfl) {
  double spacing = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < fluid.size(); ++i)
    spacing = std::min(spacing, double(fluid[i].material.spacing));
  return timeToFly(cfl * spacing, maxSpeed(next.time, next.time + next.dt), 0);
}

SolidKind SemiAnalyticalSFI::kindOf(const TriangleMesh& mesh, const std::string& from, Log& log) const {
  const MeshDiagnosis diagnosis = diagnose(mesh);
  const bool closed = diagnosis.closed() && diagnosis.inconsistentEdges == 0;
  const std::string found = diagnosis.message();
  const auto warn = [&](const std::string& what) {
    log.warn(fmt::format("node '{}': the mesh of {} triangles from '{}' {}", name(), mesh.triangles.size(),
                         from, what));
  };
  switch (fill) {
    case SolidFill::kSheet:
      if (diagnosis.inconsistentEdges > 0 || diagnosis.nonManifoldEdges > 0)
        warn("has " + found + "; its sides are not certain there");
      return SolidKind::kSheet;
    case SolidFill::kSolid:
      if (!diagnosis.good()) warn("has " + found + ", so its inside is not certain");
      return SolidKind::kSolid;
    case SolidFill::kContainer:
      if (!closed) warn("has " + found + ", so its inside is not certain");
      return SolidKind::kContainer;
    case SolidFill::kAuto:
      break;
  }
  if (closed) return diagnosis.insideOut ? SolidKind::kContainer : SolidKind::kSolid;
  warn("has " + found + " and counts as a thin sheet; \"fill\" says otherwise");
  return SolidKind::kSheet;
}

TriangleMesh SemiAnalyticalSFI::simplifiedMesh(const TriangleMesh& mesh, const std::string& from,
                                               float spacing, Log& log) const {
  SimplifiedMesh coarse = simplified(mesh, double(simplify) * spacing);
  if (coarse.mesh.triangles.size() < mesh.triangles.size())
    log.info(fmt::format("node '{}': {} of the {} triangles from '{}' do, off by at most {:.2g} m", name(),
                         coarse.mesh.triangles.size(), mesh.triangles.size(), from, coarse.deviation));
  return std::move(coarse.mesh);
}

void SemiAnalyticalSFI::configure(const SetupContext&) {
  for (std::size_t i = 0; i < fluid.size(); ++i) couplingOf(fluid, i);
  fluid.request({static_cast<int>(solids.size())});
}

void SemiAnalyticalSFI::estimate(const SetupContext&, MemoryNeeds& needs) {
  float detail = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < fluid.size(); ++i) detail = std::min(detail, fluid[i].material.spacing);
  // Simplifying makes meshes smaller than they are here.
  for (std::size_t k = 0; k < solids.size(); ++k) needs.add(Solid::maxMemory(solids[k], detail));
}

void SemiAnalyticalSFI::save(const StateWriter& to) const {
  for (std::size_t k = 0; k < parts_->size(); ++k) {
    const StateWriter part = to.in("forces").in(std::to_string(k));
    part.put("force", forces->solids[k].force);
    part.put("torque", forces->solids[k].torque);
  }
}

void SemiAnalyticalSFI::restore(const StateReader& from) {
  for (std::size_t k = 0; k < parts_->size(); ++k) {
    const StateReader part = from.in("forces").in(std::to_string(k));
    part.get("force", forces->solids[k].force);
    part.get("torque", forces->solids[k].torque);
  }
}

void SemiAnalyticalSFI::reset(const SetupContext& context) {
  parts_->clear();
  forces->solids.clear();
  carved_ = 0;
  lastFrame_ = 0;
  radius_ = 0;
  float detail = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < fluid.size(); ++i) detail = std::min(detail, fluid[i].material.spacing);
  for (std::size_t k = 0; k < solids.size(); ++k) {
    for (const Vec3f& vertex : solids[k].vertices)
      radius_ = std::max(radius_, double(length(vertex - pivot.get())));
    const std::string& from = solids.links()[k]->node().name();
    const SolidSurface surface{.kind = kindOf(solids[k], from, context.log),
                               .approximate = integrals == WallIntegralForm::kApproximate,
                               .friction = friction,
                               .noSlip = noSlip,
                               .slip = slip};
    const TriangleMesh mesh = simplifiedMesh(solids[k], from, detail, context.log);
    parts_->push_back(std::make_unique<Solid>(context.device, mesh, surface, *this, detail));
    forces->solids.push_back({from, {}, {}});
  }
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const std::int64_t removed = couplingOf(fluid, i).accept(parts_.get());
    carved_ += removed;
    if (removed > 0)
      context.log.warn(
          fmt::format("node '{}': {} of the particles of '{}' start inside solids and are left out", name(),
                      removed, fluid.links()[i]->node().name()));
  }
}

void SemiAnalyticalSFI::frame(const StepContext& context) {
  const double elapsed = context.time - lastFrame_;
  if (!(elapsed > 0)) return;
  lastFrame_ = context.time;
  for (std::size_t k = 0; k < parts_->size(); ++k) {
    Array<SolidImpulse>& impulse = parts_.get()[k]->impulse();
    const SolidImpulse sum = impulse.toHost().front();
    impulse.fillZero();
    forces->solids[k].force = sum.linear / elapsed;
    forces->solids[k].torque = sum.angular / elapsed;
  }
}

void SemiAnalyticalSFI::report(NodeReport& report) {
  std::int64_t atBirth = 0;
  for (const auto& part : *parts_) atBirth += part->carvedOnHost();
  report.statistics["particles_carved"] = carved_ + atBirth;
  report.events.push_back({"particles of emitters were born inside solids and left out", atBirth});
  Value& list = report.statistics["solids"] = Value::array();
  for (const SolidForces::OfSolid& of : forces->solids) {
    Value solid = Value::object();
    solid["solid"] = of.solid;
    solid["force"] = toValue(of.force);
    solid["torque"] = toValue(of.torque);
    list.push(std::move(solid));
  }
}

}  // namespace weir
