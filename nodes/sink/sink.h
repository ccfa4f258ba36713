// A region in which particles are removed: a box, the insides of closed meshes, or all of these.
//
// A fluid removes what is inside when it sorts its particles, once a step, at their predicted positions: what
// is on its way out is gone before it is solved for, like what leaves the fluid's domain.
#pragma once

#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/graph/node.h"
#include "framework/particles/counts_removed.h"
#include "framework/particles/sink_region.h"

namespace WEIR_API weir {

class Sink final : public Node, public OnRanks, public CountsRemoved {
 public:
  static constexpr NodeInfo kInfo{"Sink",
                                  "Removes the particles of fluids inside a box or inside closed meshes.",
                                  "drain, outflow, outlet, delete, remove, kill, hole"};
  const NodeInfo& info() const override { return kInfo; }

  Param<std::optional<Vec3f>> min{
      *this, "min", std::nullopt, {.unit = "m", .doc = "Lower corner of the box; no box without it."}};
  Param<std::optional<Vec3f>> max{
      *this, "max", std::nullopt, {.unit = "m", .doc = "Upper corner of the box; no box without it."}};
  Param<std::optional<float>> cellSize{
      *this,
      "cell_size",
      std::nullopt,
      {.unit = "m",
       .min = 0,
       .aboveMin = true,
       .doc = "Resolution of meshes; half the fluid's spacing if it is left out."}};

  Inputs<TriangleMesh> meshes{*this, "meshes", "Closed meshes; what is inside one of them is removed."};
  Output<SinkRegion> sink{*this, "sink", "The region."};

  void validate() const override;
  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void reset(const SetupContext& context) override;
  /// How many particles it has removed since the reset.
  void report(NodeReport& report) override;
  void addRemoved(std::int64_t particles) override { removedBefore_ += particles; }

 private:
  /// That of the finest fluid, which decides; 0 if nobody asks, as then there is nothing to remove.
  float finestSpacing() const;
  // Of the distances from a mesh, in m.
  float cellFor(float spacing) const { return cellSize.get().value_or(0.5f * spacing); }
  void addMesh(const SetupContext& context, std::size_t link, float spacing);

  State<Array<int>> removed_{*this, "removed"};                 // one number
  State<std::int64_t> removedBefore_{*this, "removed_before"};  // which that has not
};

}  // namespace weir
