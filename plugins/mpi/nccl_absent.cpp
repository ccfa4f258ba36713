// Builds without CUDA have no device that these could be called with.
#ifndef WEIR_HAS_CUDA

#include "framework/base/check.h"
#include "plugins/mpi/nccl_links.h"

namespace weir {

GpuId gpuIdOf(const Device&) {
  throw InternalError("a CUDA device in a build without CUDA");
}

NcclUniqueId makeNcclId(const NcclLibrary&) {
  throw InternalError("NCCL in a build without CUDA");
}

std::unique_ptr<NcclLinks> makeNcclLinks(std::shared_ptr<const NcclLibrary>, Device&, int, int,
                                         const NcclUniqueId&) {
  throw InternalError("NCCL in a build without CUDA");
}

}  // namespace weir

#endif
