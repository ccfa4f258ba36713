#include "nodes/static_boundary/static_boundary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/base/text.h"
#include "framework/base/vec_value.h"
#include "framework/graph/memory_estimate.h"
#include "framework/graph/setting_warning.h"

namespace weir {

namespace {

/// The rotation that takes the y axis to a direction of length 1.
Quatf rotationFromUp(const Vec3f& direction) {
  const Vec3f up{0, 1, 0};
  const float cosine = dot(up, direction);
  constexpr float kOpposite = -0.999999f;  // any axis across the two will do
  if (cosine < kOpposite) return {0, 1, 0, 0};
  const Vec3f axis = cross(up, direction);
  const float w = 1 + cosine;
  const float scale = 1 / std::sqrt(w * w + dot(axis, axis));
  return {w * scale, axis.x * scale, axis.y * scale, axis.z * scale};
}

}  // namespace

void BoundaryPart::validate() const {
  if (name->empty()) throw sceneError("a part has no name", "a name").inParameter(name.name());
  const Vec3f size = max.get() - min.get();
  if (!(size.x > 0 && size.y > 0 && size.z > 0))
    throw sceneError("the part's box has no volume, as min is not below max along every axis",
                     "min below max");
}

void StaticBoundary::validate() const {
  const Vec3f extent = max.get() - min.get();
  if (shape == BoundaryShape::kBox && !(extent.x > 0 && extent.y > 0 && extent.z > 0))
    throw sceneError("the box has no volume, as min is not below max along every axis", "min below max");
  if (length(normal.get()) == 0)
    throw sceneError("the normal is [0, 0, 0]", "a direction").inParameter(normal.name());
  if (!parts.empty() && !reportForces)
    throw sceneError("parts are named, but no forces are reported", "\"report_forces\": true, or no parts")
        .inParameter(parts.name());
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (*parts[i].name == *parts[k].name)
        throw sceneError("two parts are called " + inQuotes(*parts[i].name), "names that differ")
            .inParameter(parts.name());
}

Shape StaticBoundary::analyticShape() const {
  Shape result;
  result.position = position;
  result.rotation = rotation->toQuaternion();
  result.radius = radius;
  result.height = height;
  result.inverted = inverted;
  switch (shape.get()) {
    case BoundaryShape::kNone:
    case BoundaryShape::kBox:
      result.kind = ShapeKind::kBox;
      result.position = (min.get() + max.get()) * 0.5f;
      result.halfSize = (max.get() - min.get()) * 0.5f;
      break;
    case BoundaryShape::kSphere:
      result.kind = ShapeKind::kSphere;
      break;
    case BoundaryShape::kCylinder:
      result.kind = ShapeKind::kCylinder;
      break;
    case BoundaryShape::kCapsule:
      result.kind = ShapeKind::kCapsule;
      break;
    case BoundaryShape::kCone:
      result.kind = ShapeKind::kCone;
      break;
    case BoundaryShape::kPlane:
      result.kind = ShapeKind::kPlane;
      result.rotation = rotationFromUp(normalized(normal.get()));
      break;
  }
  return result;
}

BoundaryPiece StaticBoundary::piece() const {
  BoundaryPiece result;
  result.restitution = restitution;
  result.friction = friction;
  result.slip = slip;
  return result;
}

void StaticBoundary::bound(BoundaryPiece& piece, const std::optional<Aabb>& bounds) {
  if (!bounds) return;
  constexpr float kRounding = 1e-4f;  // of the size
  const Vec3f size = bounds->size();
  const float margin = (piece.inverted() ? -kRounding : kRounding) * (size.x + size.y + size.z);
  piece.bounded = true;
  piece.bounds = {bounds->lo - Vec3f{margin, margin, margin}, bounds->hi + Vec3f{margin, margin, margin}};
}

void StaticBoundary::configure(const SetupContext&) {
  for (const Boundary::Request& request : boundary.requests()) boundaries.request(request);
}

Boundary::Request StaticBoundary::finestRequest() const {
  Boundary::Request finest{.spacing = std::numeric_limits<float>::infinity()};
  for (const Boundary::Request& request : boundary.requests())
    finest = {std::min(finest.spacing, request.spacing), std::max(finest.reach, request.reach)};
  return finest;
}

bool StaticBoundary::rubs() const {
  bool any = friction > 0;
  for (std::size_t i = 0; i < boundaries.size(); ++i) any = any || boundaries[i].rubs;
  return any;
}

void StaticBoundary::estimate(const SetupContext&, MemoryNeeds& needs) {
  boundary->rubs = rubs();
  boundary->reportsForces = reportForces;
  if (boundary.requests().empty()) return;
  const Boundary::Request finest = finestRequest();
  for (std::size_t i = 0; i < meshes.size(); ++i)
    needs.add(MeshSdf::maxMemory(meshes[i], cellFor(finest), bandFor(finest)));
}

void StaticBoundary::reset(const SetupContext& context) {
  if (shape == BoundaryShape::kNone && meshes.empty() && boundaries.empty())
    throw sceneError("the boundary is empty: it has no shape, and nothing is linked to it",
                     "a shape, or a link to its meshes or its boundaries");
  *boundary = {};
  boundary->rubs = rubs();
  boundary->reportsForces = reportForces;
  boundary->pivot = pivot;
  lastFrame_ = 0;
  const std::size_t sums = reportForces ? 1 + parts.size() : 0;
  forces_->assign(sums, {});
  torques_->assign(sums, {});
  impulses_ = Array<SolidImpulse>(context.device, static_cast<std::int64_t>(sums));
  impulses_->fillZero();
  if (reportForces) boundary->impulses = &*impulses_;
  for (std::size_t i = 0; i < parts.size(); ++i) boundary->parts.push_back({*parts[i].min, *parts[i].max});
  if (shape != BoundaryShape::kNone) {
    boundary->pieces.push_back(piece());
    boundary->pieces.back().shape = analyticShape();
    bound(boundary->pieces.back(), boundsOf(analyticShape()));
  }
  // The finest fluid decides. Without one nobody asks for distances, and building them would be for nothing.
  const auto requests = boundary.requests();
  if (!requests.empty()) {
    const Boundary::Request finest = finestRequest();
    for (std::size_t i = 0; i < meshes.size(); ++i) addMesh(context, i, finest);
    float coarsest = 0;
    for (const Boundary::Request& request : requests) coarsest = std::max(coarsest, request.spacing);
    warnOfThinness(context, coarsest);
  }
  for (std::size_t i = 0; i < boundaries.size(); ++i) {
    const Boundary& other = boundaries[i];
    if (other.reportsForces)
      context.log.warn(
          fmt::format("node '{}': forces on it are not reported where '{}' includes it; link it to the "
                      "fluid, or set \"report_forces\" of '{}'",
                      boundaries.links()[i]->node().name(), name(), name()));
    boundary->pieces.insert(boundary->pieces.end(), other.pieces.begin(), other.pieces.end());
    boundary->meshes.insert(boundary->meshes.end(), other.meshes.begin(), other.meshes.end());
  }
  boundary->onDevice = Array<BoundaryPiece>(context.device, boundary->pieces);
}

void StaticBoundary::frame(const StepContext& context) {
  const double elapsed = context.time - lastFrame_;
  if (!reportForces || !(elapsed > 0)) return;
  lastFrame_ = context.time;
  const std::vector<SolidImpulse> sums = impulses_->toHost();
  impulses_->fillZero();
  for (std::size_t i = 0; i < sums.size(); ++i) {
    (*forces_)[i] = sums[i].linear / elapsed;
    (*torques_)[i] = sums[i].angular / elapsed;
  }
}

void StaticBoundary::report(NodeReport& report) {
  if (!reportForces) return;
  const auto put = [&](Value& to, std::size_t i) {
    to["force"] = toValue((*forces_)[i]);
    to["torque"] = toValue((*torques_)[i]);
  };
  put(report.statistics, 0);
  if (parts.empty()) return;
  Value ofParts = Value::object();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Value part = Value::object();
    put(part, i + 1);
    ofParts[*parts[i].name] = std::move(part);
  }
  report.statistics["parts"] = std::move(ofParts);
}

double StaticBoundary::thickness() const {
  const Vec3f size = max.get() - min.get();
  switch (shape.get()) {
    case BoundaryShape::kBox:
      return std::min({size.x, size.y, size.z});
    case BoundaryShape::kSphere:
    case BoundaryShape::kCapsule:
      return 2 * double(radius);
    case BoundaryShape::kCylinder:
    case BoundaryShape::kCone:
      return std::min<double>(2 * double(radius), height);
    case BoundaryShape::kNone:
    case BoundaryShape::kPlane:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

void StaticBoundary::warnOfThinness(const SetupContext& context, float spacing) const {
  const double spacings = inverted ? kMinSpacings : 1;
  if (thickness() >= spacings * spacing * (1 - kSettingRounding)) return;
  warnOfSetting(context.log, fmt::format("node '{}'", name()),
                fmt::format("the {} is {:.3g} spacings thick, so {}", inverted ? "room inside" : "solid",
                            thickness() / spacing,
                            inverted ? "the fluid in it is not resolved" : "particles may pass through it"),
                fmt::format("a thickness of at least {:.2g} m, or a spacing of at most {:.2g} m",
                            spacings * spacing, thickness() / spacings));
}

void StaticBoundary::addMesh(const SetupContext& context, std::size_t link, const Boundary::Request& finest) {
  std::vector<std::string> warnings;
  auto sdf = std::make_shared<const MeshSdf>(context.device, meshes[link], cellFor(finest), bandFor(finest),
                                             warnings);
  for (const std::string& warning : warnings)
    context.log.warn(
        fmt::format("node '{}': the mesh from '{}': {}", name(), meshes.links()[link]->path(), warning));
  boundary->pieces.push_back(piece());
  boundary->pieces.back().isMesh = true;
  boundary->pieces.back().mesh = sdf->view(inverted);
  // Distances are interpolated, so points a cell away from the mesh may be told nearer than they are.
  const float cell = cellFor(finest);
  const Vec3f margin{cell, cell, cell};
  const Aabb bounds = meshes[link].bounds();
  if (!inverted) bound(boundary->pieces.back(), Aabb{bounds.lo - margin, bounds.hi + margin});
  boundary->meshes.push_back(std::move(sdf));
}

}  // namespace weir
