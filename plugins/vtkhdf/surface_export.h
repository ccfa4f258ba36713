// --export-surface FILE.vtkhdf: writes the surfaces of all fluids of a scene, frame by frame, to one file.
//
// A surface is what a node puts out that makes a DynamicMesh, such as a FluidSurface. The file holds its
// triangles as polygons, with the vertices' normals as PointData. If the scene has several such nodes, a
// number tells which surface a vertex belongs to. The group /simulation, which readers of VTKHDF ignore,
// keeps the version of Weir, the scene's text and the names of the nodes.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/geometry/dynamic_mesh_copy.h"
#include "framework/graph/port.h"
#include "framework/run/output_kind.h"
#include "plugins/vtkhdf/export_file.h"

namespace weir {

/// The attribute that tells surfaces apart: 0 for the first name in /simulation/surfaces, and so on.
inline constexpr const char* kSurfaceIndexName = "surface_index";

class SurfaceExport final : public Observer {
 public:
  explicit SurfaceExport(std::filesystem::path file) : file_(std::move(file)) {}

  std::string name() const override { return "surface export"; }
  std::string_view stateName() const override { return "vtkhdf_surface"; }
  /// Throws an io Error if the scene has no surface of a fluid or the file cannot be written.
  void begin(Simulation& simulation) override;
  void save(const StateWriter& to) override;
  void resume(Simulation& simulation, const StateReader& from) override;
  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override;
  /// Throws an io Error if the frame cannot be written. The frames before it stay readable.
  void write(Snapshot& snapshot) override;
  void end(Simulation& simulation, RunEnd how) override;

 private:
  struct Source {
    std::string node;
    const Output<DynamicMesh>* mesh;
  };
  class Frame;

  void openFile();

  ExportFile file_;
  std::vector<Source> sources_;
};

class SurfaceExportKind final : public OutputKind {
 public:
  std::vector<OutputOption> options() const override;
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override;
};

}  // namespace weir
