// What the plugin adds to the registry.
#include "framework/graph/plugin_header.h"
#include "plugins/mesh_export/particle_sequence.h"
#include "plugins/mesh_export/surface_sequence.h"

WEIR_PLUGIN("mesh_export",
            "Writes surfaces of fluids and particles as PLY and OBJ files, one for each frame.", registry) {
  using namespace weir;
  registry.addService<OutputKind>("surface files", [] { return std::make_unique<SurfaceSequenceKind>(); });
  registry.addService<OutputKind>("particle files", [] { return std::make_unique<ParticleSequenceKind>(); });
}
