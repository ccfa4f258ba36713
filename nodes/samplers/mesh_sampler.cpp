#include "nodes/samplers/mesh_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/geometry/mesh_query.h"

namespace weir {

std::vector<Lattice> MeshSampler::lattices(bool closed) const {
  const Aabb box = surface->bounds();
  std::vector<Lattice> all{Lattice::inBox(box, requestedSpacing(), makers())};
  if (closed && margin == 0) all.push_back(Lattice::filling(box, requestedSpacing(), makers()));
  return all;
}

double MeshSampler::maxParticleCount() const {
  const TriangleMesh& mesh = *surface;
  const Aabb box = mesh.bounds();
  if (mesh.empty() || !isFinite(box.lo) || !isFinite(box.hi)) return 0;  // reset() says so
  const double spacing = requestedSpacing();
  const bool closed = diagnose(mesh).closed();
  double nodes = 0;
  for (const Lattice& lattice : lattices(closed))
    nodes = std::max(nodes, static_cast<double>(lattice.size()));
  if (!closed) return nodes;
  // The cells around the nodes reach less than a spacing beyond the surface.
  const double volume = std::abs(mesh.volume()) + mesh.area() * spacing;
  return std::min(nodes, std::ceil(volume / (spacing * spacing * spacing)));
}

double MeshSampler::regionMemory() const {
  return MeshSdf::maxMemory(*surface, sdfCell(requestedSpacing()), sdfBand(requestedSpacing()));
}

void MeshSampler::reset(const SetupContext& context) {
  const float spacing = requestedSpacing();
  const TriangleMesh& mesh = *surface;
  const Aabb box = mesh.bounds();
  if (mesh.empty() || !isFinite(box.lo) || !isFinite(box.hi))
    throw sceneError("the mesh from '" + surface.links().front()->path() + "' is empty or has no finite size",
                     "a mesh with an inside");
  const MeshDiagnosis diagnosis = diagnose(mesh);
  if (!diagnosis.good())
    context.log.warn(fmt::format("node '{}': the mesh from '{}' has {}, so what is inside it is a guess",
                                 name(), surface.links().front()->path(), diagnosis.message()));
  const MeshQuery query(mesh);
  // A mesh that is inside out has winding numbers of -1 inside.
  const double sign = diagnosis.insideOut ? -1 : 1;
  const auto inside = [&](const Vec3f& p) {
    constexpr double kHalf = 0.5;  // between outside, 0, and inside, 1
    return sign * query.windingNumber(p) > kHalf &&
           (margin == 0 || query.closestDistance(p, 2 * margin) >= margin);
  };
  const auto region = [&] { return regionOf(context, mesh, spacing); };
  const double volume = std::abs(mesh.volume());
  fill(context, lattices(diagnosis.closed()), volume, region, inside);
  const Vec3f size = box.hi - box.lo;
  warnOfThinness(context, std::min({size.x, size.y, size.z}), spacing);
  if (diagnosis.closed() && margin == 0) warnOfRounding(context, volume, spacing);
}

Sampler::Region MeshSampler::regionOf(const SetupContext& context, const TriangleMesh& mesh,
                                      float spacing) const {
  std::vector<std::string> known;  // reset() has said what is wrong with the mesh
  const float contact = contactAt(spacing);
  auto sdf = std::make_shared<const MeshSdf>(context.device, mesh, sdfCell(spacing), sdfBand(spacing), known);
  auto outside = std::make_shared<Boundary>();
  BoundaryPiece piece;
  piece.isMesh = true;
  piece.mesh = sdf->view(true);
  outside->pieces.push_back(piece);
  outside->meshes.push_back(std::move(sdf));
  outside->onDevice = Array<BoundaryPiece>(context.device, outside->pieces);
  return {std::move(outside), contact};
}

}  // namespace weir
