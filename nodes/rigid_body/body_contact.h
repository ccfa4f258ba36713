// Moves a body on at the end of a step, and keeps its vertices out of walls given by signed distance.
//
// With d the distance of a vertex from a wall at the end of the step, n the wall's normal and u = v + ω×r the
// vertex's velocity, which has brought it there from d − dt·n·u, impulses j along n, at least 0, lead to
//
//   n·u' ≥ −max(d − dt·n·u, 0)/dt      (it stops at the wall)
//   n·u' ≥ −ε·n·u                      (it bounces, if it comes faster than it falls in two steps)
//
// and impulses along the wall, at most μ·j, to no sliding. They are found by projected Gauss-Seidel, in the
// order of the vertices. The body then stands where the changed velocity leads, so that what rests or sticks
// does not creep; what is still within a wall is moved out without a velocity.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/solids/free_body.h"
#include "nodes/static_boundary/boundary.h"

namespace WEIR_API weir {

/// What of a body others touch.
enum class ContactShape { kMesh, kHull };

struct ContactMaterial {
  double friction = 0, restitution = 0;
};

class BodyContact {
 public:
  /// For a body with that mesh.
  void reset(Device& device, const TriangleMesh& mesh, const std::vector<const Boundary*>& walls,
             const ContactMaterial& material);
  /// The end of a step of `dt` s, whether or not a fluid has placed the body. If it `holds`, walls
  /// keep the body out.
  void step(Array<FreeBody>& body, const Vec3f& gravity, double dt, bool holds);
  /// How deep its deepest vertex is within a wall, in m; 0 if none is. Waits for the device.
  double depthOf(const BodyMass& mass, const BodyState& at);
  static double memoryFor(double vertices);

 private:
  template <class Backend>
  void stepOn(Backend& device, Array<FreeBody>& body, const Vec3f& gravity, double dt, bool holds);

  template <class Backend>
  void depthOn(Backend& device, const BodyMass& mass, const BodyState& at);

  Array<Vec3f> vertices_;
  Array<BoundaryPiece> pieces_;
  Array<std::uint8_t> marks_;
  Array<int> near_, nearCount_;
  Array<float> depth_;
  ContactMaterial material_;
};

}  // namespace weir
