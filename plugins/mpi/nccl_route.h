// Parcels from GPU to GPU by NCCL, which is set up by way of MPI; or by the hosts where that cannot be had.
#pragma once

#include <memory>

#include "framework/communication/parcel_route.h"
#include "plugins/mpi/mpi_rank.h"

namespace weir {

/// All ranks take part and get the same; null on CPUs. Both must outlive it.
std::unique_ptr<ParcelRoute> openNcclRoute(MpiRank& rank, Device& device);

}  // namespace weir
