// Solids that do not move: one analytic shape, any number of triangle meshes, and other boundaries, as one.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/graph/node.h"
#include "framework/solids/solid.h"
#include "nodes/static_boundary/boundary.h"

namespace WEIR_API weir {

/// ShapeKind, and none.
enum class BoundaryShape { kNone, kBox, kSphere, kCylinder, kCapsule, kCone, kPlane };
template <>
struct EnumNames<BoundaryShape> {
  static constexpr std::array<EnumName, 7> kNames{
      EnumName{"none", "No shape: meshes and other boundaries only."},
      EnumName{"box", "From min to max, turned about its centre by rotation."},
      EnumName{"sphere", "Of radius about position."},
      EnumName{"cylinder", "Of radius and height about position; its axis is y."},
      EnumName{"capsule", "A cylinder of radius and height with half spheres on its ends."},
      EnumName{"cone", "Its base, of radius, stands at position; its tip is height above, along y."},
      EnumName{"plane", "All that is below position, seen along normal."}};
};

/// A part of a boundary, whose force and torque are reported, too.
struct BoundaryPart : Configurable {
  Param<std::string> name{*this, "name", "", {.doc = "What its numbers are called."}};
  Param<Vec3f> min{
      *this, "min", {}, {.unit = "m", .doc = "Lower corner of a box: fluid in it pushes this part."}};
  Param<Vec3f> max{*this, "max", {1, 1, 1}, {.unit = "m", .doc = "Upper corner of that box."}};

  void validate() const override;
};

class StaticBoundary final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{
      "StaticBoundary", "Solids or containers that do not move: shapes and meshes by signed distance.",
      "tank, wall, collider, container, obstacle, floor, ground, solid, box, sphere, plane, cylinder, cup, "
      "glass, sdf"};
  const NodeInfo& info() const override { return kInfo; }

  Param<BoundaryShape> shape{*this, "shape", BoundaryShape::kNone, {.doc = "The analytic shape."}};
  Param<Vec3f> min{*this,
                   "min",
                   {-0.5f, 0, -0.5f},
                   {.unit = "m", .doc = "Lower corner of the box.", .onlyFor = "shape: box"}};
  Param<Vec3f> max{*this,
                   "max",
                   {0.5f, 1, 0.5f},
                   {.unit = "m", .doc = "Upper corner of the box.", .onlyFor = "shape: box"}};
  Param<Vec3f> position{*this,
                        "position",
                        {},
                        {.unit = "m",
                         .doc = "Where the shape is.",
                         .onlyFor = "shape: sphere, cylinder, capsule, cone, plane"}};
  Param<float> radius{*this,
                      "radius",
                      0.5f,
                      {.unit = "m",
                       .min = 0,
                       .aboveMin = true,
                       .doc = "Radius.",
                       .onlyFor = "shape: sphere, cylinder, capsule, cone"}};
  Param<float> height{*this,
                      "height",
                      1,
                      {.unit = "m",
                       .min = 0,
                       .aboveMin = true,
                       .doc = "Height of a cylinder or cone, length of a capsule's axis.",
                       .onlyFor = "shape: cylinder, capsule, cone"}};
  Param<Vec3f> normal{*this,
                      "normal",
                      {0, 1, 0},
                      {.doc = "Which way a plane faces; of any length but 0.", .onlyFor = "shape: plane"}};
  Param<Rotation> rotation{
      *this,
      "rotation",
      {},
      {.unit = "degrees", .doc = "Turns the shape.", .onlyFor = "shape: box, cylinder, capsule, cone"}};
  Param<bool> inverted{
      *this,
      "inverted",
      false,
      {.doc = "The solid is all that is outside: a container. For the shape and the meshes alike.",
       .also = "container, inside, tank, hollow"}};
  Param<std::optional<float>> cellSize{
      *this,
      "cell_size",
      std::nullopt,
      {.unit = "m",
       .min = 0,
       .aboveMin = true,
       .doc = "Resolution of the distance to meshes; half the fluid's spacing if it is left out."}};
  Param<float> restitution{
      *this,
      "restitution",
      0,
      {.min = 0, .max = 1, .doc = "Share of its speed into the wall that a particle bounces back with."}};
  Param<float> friction{
      *this,
      "friction",
      0,
      {.min = 0, .softMax = 1, .doc = "Coulomb's coefficient of friction.", .also = "slip, rough"}};
  Param<float> slip{
      *this,
      "slip",
      0,
      {.min = 0,
       .max = 1,
       .doc = "Of viscous fluid (ViscositySolver) along the surface: 0 sticks to it, 1 is not held at all."}};

  Param<bool> reportForces{
      *this,
      "report_forces",
      false,
      {.doc = "Report the force and the torque of fluids on it; takes 16 bytes a particle.",
       .also = "measure, load"}};
  Param<Vec3f> pivot{
      *this, "pivot", {}, {.unit = "m", .doc = "The point about which that torque is counted."}};

  GroupList<BoundaryPart> parts{
      *this, "parts", "Parts whose force and torque are reported, too: each feels the fluid in a box."};

  Inputs<TriangleMesh> meshes{*this, "meshes", "Meshes that are solid, or containers if inverted."};
  Inputs<Boundary> boundaries{*this, "boundaries", "Other boundaries that this one shall include."};
  Output<Boundary> boundary{*this, "boundary", "All of these together."};

  void validate() const override;
  void configure(const SetupContext& context) override;
  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void reset(const SetupContext& context) override;
  void frame(const StepContext& context) override;
  void report(NodeReport& report) override;

 private:
  Shape analyticShape() const;
  BoundaryPiece piece() const;
  static void bound(BoundaryPiece& piece, const std::optional<Aabb>& bounds);
  bool rubs() const;
  double thickness() const;  ///< of the shape, in m
  void warnOfThinness(const SetupContext& context, float spacing) const;
  /// The smallest spacing and the longest reach of all fluids.
  Boundary::Request finestRequest() const;
  // Of the distances from a mesh, in m. The fluid feels the surface in the band.
  float cellFor(const Boundary::Request& of) const { return cellSize.get().value_or(0.5f * of.spacing); }
  float bandFor(const Boundary::Request& of) const {
    return std::max(2 * of.spacing, of.reach + cellFor(of));
  }
  void addMesh(const SetupContext& context, std::size_t link, const Boundary::Request& finest);

  // Of all of it, and of each part: since the frame before; N and N·m, means between frames.
  State<Array<SolidImpulse>> impulses_{*this, "impulses"};
  State<std::vector<Vec3d>> forces_{*this, "forces"}, torques_{*this, "torques"};
  State<double> lastFrame_{*this, "last_frame"};  // s
};

}  // namespace weir
