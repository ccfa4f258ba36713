#include "framework/graph/plugin_header.h"
#include "plugins/openvdb/volume_export.h"

WEIR_PLUGIN("openvdb", "Exports the volume of fluids to OpenVDB files, for renderers such as Blender's.",
            registry) {
  using namespace weir;
  registry.addSection<VolumeSettings>("vdb", "What --vdb writes.");
  registry.addService<OutputKind>("vdb", [] { return std::make_unique<VolumeExportKind>(); });
}
