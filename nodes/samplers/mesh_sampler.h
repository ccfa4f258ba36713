// The inside of a mesh full of particles.
#pragma once

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"
#include "nodes/samplers/sampler.h"

namespace WEIR_API weir {

class MeshSampler final : public Sampler {
 public:
  static constexpr NodeInfo kInfo{"MeshSampler", "Fills the inside of a mesh with particles.",
                                  "volume, initial, fill, water"};
  const NodeInfo& info() const override { return kInfo; }

  Param<float> margin{
      *this, "margin", 0, {.unit = "m", .min = 0, .doc = "No particle is closer to the surface than this."}};

  Input<TriangleMesh> surface{*this, "surface", "The mesh to fill; small holes do no harm."};

  void reset(const SetupContext& context) override;

 protected:
  double maxParticleCount() const override;
  double regionMemory() const override;

 private:
  /// In the mesh's bounds: cubic, and one that fills them, which counts where the first has too many nodes in
  /// a closed mesh, or too few. Beside a margin the volume to fill is not known, so the first stays alone.
  std::vector<Lattice> lattices(bool closed) const;
  float contactAt(float spacing) const { return margin + 0.5f * spacing; }
  // Of the region's distances, in m.
  float sdfCell(float spacing) const { return 0.5f * spacing; }
  float sdfBand(float spacing) const { return contactAt(spacing) + 2 * spacing; }
  Region regionOf(const SetupContext& context, const TriangleMesh& mesh, float spacing) const;
};

}  // namespace weir
