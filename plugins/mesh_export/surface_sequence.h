// --ply DIR and --obj DIR: each frame's surfaces of fluids as files of their own.
//
// A surface is what a node puts out that makes a DynamicMesh, such as a FluidSurface. Its files are named
// after the node and the frame: surface_00012.ply. A frame without fluid has a file without triangles, so
// that numbers and times agree. A run that is resumed goes on with the numbers that follow.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/geometry/dynamic_mesh.h"
#include "framework/graph/port.h"
#include "framework/run/output_kind.h"
#include "plugins/mesh_export/frame_files.h"

namespace weir {

class SurfaceSequence final : public Observer {
 public:
  explicit SurfaceSequence(OutputPaths paths) : paths_(std::move(paths)) {}

  std::string name() const override { return "surface files"; }
  std::string_view stateName() const override { return "surface_files"; }
  /// Throws an io Error if the scene has no such node, or a folder cannot be used.
  void begin(Simulation& simulation) override;
  void resume(Simulation& simulation, const StateReader&) override { begin(simulation); }
  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override;
  void write(Snapshot& snapshot) override;
  void end(Simulation&, RunEnd) override {}

 private:
  struct Source {
    std::string node;
    const Output<DynamicMesh>* mesh;
  };
  class Frame;

  OutputPaths paths_;
  std::vector<Source> sources_;
  std::optional<FrameFiles> ply_, obj_;
};

class SurfaceSequenceKind final : public OutputKind {
 public:
  std::vector<OutputOption> options() const override;
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override;
};

}  // namespace weir
