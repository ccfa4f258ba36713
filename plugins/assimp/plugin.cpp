#include "framework/graph/plugin_header.h"

#include "plugins/assimp/assimp_reader.h"

WEIR_PLUGIN("assimp", "Reads mesh files.", registry) {
  registry.addService<weir::MeshReader>("assimp", [] { return std::make_unique<weir::AssimpReader>(); });
}
