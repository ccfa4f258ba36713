// --export-solids FILE.vtkhdf: writes the surfaces of all solids of a scene, bodies included, frame by frame
// where they stand, to one file.
//
// A solid is a mesh that a node puts out, once for each node that moves it, as one mesh may serve many bodies
// (motion_of.h). The PointData has the velocity of each vertex, the mean since the frame before, and a number
// that tells solids apart. The group /simulation, which readers of VTKHDF ignore, keeps the version of Weir,
// the scene's text and the names of the solids in the order of their numbers.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/geometry/triangle_mesh.h"
#include "framework/run/output_kind.h"
#include "framework/solids/solid.h"
#include "plugins/vtkhdf/export_file.h"

namespace weir {

/// The attribute that tells solids apart: 0 for the first name in /simulation/solids, and so on.
inline constexpr const char* kSolidIndexName = "solid_index";

class SolidExport final : public Observer {
 public:
  explicit SolidExport(std::filesystem::path file) : file_(std::move(file)) {}

  std::string name() const override { return "export of solids"; }
  std::string_view stateName() const override { return "vtkhdf_solids"; }
  /// Throws an io Error if the scene has no mesh or the file cannot be written.
  void begin(Simulation& simulation) override;
  void save(const StateWriter& to) override;
  void resume(Simulation& simulation, const StateReader& from) override;
  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override;
  /// Throws an io Error if the frame cannot be written. The frames before it stay readable.
  void write(Snapshot& snapshot) override;
  void end(Simulation& simulation, RunEnd how) override;

 private:
  struct Source {
    std::string name;
    const TriangleMesh* mesh;
    const RigidMotion* motion;  // null for one at rest
  };
  struct Frame;

  void collect(const Simulation& simulation);
  void openFile();

  ExportFile file_;
  std::vector<Source> sources_;
  std::vector<std::int32_t> indices_;  // of each vertex
  std::vector<Vec3i> triangles_;       // of all solids
};

class SolidExportKind final : public OutputKind {
 public:
  std::vector<OutputOption> options() const override;
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override;
};

}  // namespace weir
