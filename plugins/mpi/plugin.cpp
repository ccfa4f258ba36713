// What the plugin adds to the registry.
#include "framework/graph/plugin_header.h"
#include "plugins/mpi/mpi_ranks.h"

WEIR_PLUGIN("mpi", "Runs scenes on the ranks that mpirun or srun has started.", registry) {
  using namespace weir;
  registry.addService<LaunchedRanks>("mpi", [] { return std::make_unique<MpiRanks>(); });
  registry.addService<InfoSource>("mpi", [] { return std::make_unique<MpiInfo>(); });
}
