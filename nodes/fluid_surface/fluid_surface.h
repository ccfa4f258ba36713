// The surface of a particle fluid as a triangle mesh, made anew for each frame.
//
// particle_kernels.h says which field is zero outside and one inside of the fluid, kernel_field.h how it is
// summed, and marching_cubes.h how the mesh is made of it.
#pragma once

#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/geometry/dynamic_mesh.h"
#include "framework/graph/node.h"
#include "framework/particles/particles.h"
#include "nodes/fluid_surface/fluid_mesher.h"

namespace WEIR_API weir {

/// On several ranks, the first one makes it.
class FluidSurface final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{
      "FluidSurface", "The surface of a fluid as a closed triangle mesh, for pictures and export.",
      "mesh, skin, marching cubes, reconstruction, export, render"};
  const NodeInfo& info() const override { return kInfo; }

  Param<float> cellSize{*this,
                        "cell_size",
                        0.5f,
                        {.unit = "spacings",
                         .min = 0.1,
                         .max = 4,
                         .softMin = 0.25,
                         .softMax = 1,
                         .doc = "Of the grid on which the surface is found. Smaller is finer and slower."}};
  Param<float> kernelRadius{*this,
                            "kernel_radius",
                            2.5f,
                            {.unit = "spacings",
                             .min = 1.5,
                             .max = 4,
                             .softMin = 2,
                             .softMax = 3,
                             .doc = "How far a particle reaches within fluid. Larger is smoother, and rounds "
                                    "off more."}};
  Param<float> smoothing{
      *this,
      "smoothing",
      0.9f,
      {.min = 0,
       .max = 1,
       .doc =
           "How far particles are moved to the mean of those around them: 0 leaves them, 1 is all the way."}};
  Param<float> anisotropy{
      *this,
      "anisotropy",
      4,
      {.min = 1,
       .max = 10,
       .doc = "The largest ratio of a particle's axes, which lie along the fluid; 1 makes balls of them."}};
  Param<int> meshSmoothing{
      *this,
      "mesh_smoothing",
      0,
      {.min = 0,
       .max = 100,
       .doc = "Passes that smooth the mesh without shrinking it. n of them halve waves of 2 sqrt(n) "
              "cells, and take away shorter ones."}};
  Param<std::optional<float>> level{
      *this,
      "level",
      std::nullopt,
      {.min = 0,
       .max = 1,
       .aboveMin = true,
       .doc = "The field's value at the surface, about 1 being full fluid. If it is left out: such that a "
              "flat surface is half a spacing outside of the outermost particles."}};

  Input<Particles> fluid{*this, "fluid", "The particles of the fluid."};
  Output<DynamicMesh> surface{*this, "surface", "Its surface at the time of the last frame."};

  /// What the parameters say.
  FluidMeshSettings meshSettings() const;

  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void join(Communicator& ranks) override { isShown_ = ranks.rank() == 0; }
  void reset(const SetupContext& context) override;
  void frame(const StepContext& context) override;
  void report(NodeReport& report) override;

 private:
  std::optional<FluidMesher> mesher_;
  bool isShown_ = true;
};

}  // namespace weir
