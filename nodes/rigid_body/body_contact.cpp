#include "nodes/rigid_body/body_contact.h"

#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"

namespace weir {

void BodyContact::reset(Device& device, const TriangleMesh& mesh, const std::vector<const Boundary*>& walls,
                        const ContactMaterial& material) {
  std::vector<BoundaryPiece> pieces;
  for (const Boundary* of : walls) pieces.insert(pieces.end(), of->pieces.begin(), of->pieces.end());
  pieces_ = Array<BoundaryPiece>(device, pieces);
  vertices_ = Array<Vec3f>(device, mesh.vertices);
  marks_ = Array<std::uint8_t>(device, vertices_.size());
  near_ = Array<int>(device, vertices_.size());
  nearCount_ = Array<int>(device, 1);
  depth_ = Array<float>(device, 1);
  material_ = material;
}

void BodyContact::step(Array<FreeBody>& body, const Vec3f& gravity, double dt, bool holds) {
  dispatch(body.device(), [&](auto& device) { stepOn(device, body, gravity, dt, holds); });
}

double BodyContact::depthOf(const BodyMass& mass, const BodyState& at) {
  if (pieces_.empty()) return 0;
  dispatch(depth_.device(), [&](auto& device) { depthOn(device, mass, at); });
  return depth_.toHost().front();
}

double BodyContact::memoryFor(double vertices) {
  return bytesOfArray(vertices, sizeof(Vec3f) + sizeof(std::uint8_t) + sizeof(int));
}

}  // namespace weir
