// What the plugin adds to the registry.
#include "framework/graph/plugin_header.h"
#include "framework/run/info_source.h"
#include "plugins/vtkhdf/checkpoint_file.h"
#include "plugins/vtkhdf/export_settings.h"
#include "plugins/vtkhdf/file_contents.h"
#include "plugins/vtkhdf/hdf5.h"
#include "plugins/vtkhdf/particle_export.h"
#include "plugins/vtkhdf/solid_export.h"
#include "plugins/vtkhdf/surface_export.h"
#include "plugins/vtkhdf/vtkhdf_mesh_reader.h"
#include "plugins/vtkhdf/vtkhdf_particle_reader.h"
#include "plugins/vtkhdf/vtkhdf_recording.h"

namespace weir {
namespace {

class Hdf5Info final : public InfoSource {
 public:
  std::vector<InfoEntry> info() const override {
    const hdf5::Session session;
    unsigned major = 0, minor = 0, release = 0;
    if (H5get_libversion(&major, &minor, &release) < 0) return {{"HDF5", "the library does not start"}};
    return {{"HDF5", std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release) +
                         "; writes VTKHDF 2.0"}};
  }
};

}  // namespace
}  // namespace weir

WEIR_PLUGIN("vtkhdf",
            "Exports particles and surfaces to VTKHDF files, for ParaView and VTK, and reads both back.",
            registry) {
  using namespace weir;
  registry.addSection<ExportSettings>("export", "What --export writes: attributes, frames, precision.");
  registry.addService<OutputKind>("vtkhdf", [] { return std::make_unique<ParticleExportKind>(); });
  registry.addService<OutputKind>("vtkhdf surfaces", [] { return std::make_unique<SurfaceExportKind>(); });
  registry.addService<OutputKind>("vtkhdf solids", [] { return std::make_unique<SolidExportKind>(); });
  registry.addService<MeshReader>("vtkhdf", [] { return std::make_unique<VtkHdfMeshReader>(); });
  registry.addService<ParticleReader>("vtkhdf", [] { return std::make_unique<VtkHdfParticleReader>(); });
  registry.addService<RecordingReader>("vtkhdf", [] { return std::make_unique<VtkHdfRecordingReader>(); });
  registry.addService<CheckpointStore>("hdf5", [] { return std::make_unique<Hdf5CheckpointStore>(); });
  registry.addService<FileContentsReader>("checkpoints",
                                          [] { return std::make_unique<CheckpointContents>(); });
  registry.addService<FileContentsReader>("vtkhdf", [] { return std::make_unique<VtkHdfContents>(); });
  registry.addService<InfoSource>("vtkhdf", [] { return std::make_unique<Hdf5Info>(); });
}
