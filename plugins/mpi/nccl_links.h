// The GPU's side of parcels by NCCL, in the order of its work; the host waits for nothing.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "framework/compute/array.h"
#include "plugins/mpi/nccl_library.h"

namespace weir {

/// What tells GPUs apart, on all machines. Of a CUDA device.
using GpuId = std::array<std::byte, 16>;
GpuId gpuIdOf(const Device& device);

NcclUniqueId makeNcclId(const NcclLibrary& nccl);

class NcclLinks {
 public:
  using Batch = std::vector<Array<std::byte>>;
  virtual ~NcclLinks() = default;

  /// As in ParcelTransport.
  virtual void exchange(std::vector<Batch> toRanks, std::vector<Batch>& fromRanks) = 0;

  /// Whether the device has done all that it was asked for.
  virtual bool areIdle() = 0;
  /// Once nothing is on its way between any ranks, which all call it.
  virtual void close() = 0;
  /// Gives up what is on its way, unless it goes within a second. The destructor does so, too.
  virtual void drop() noexcept = 0;
};

/// All ranks take part, each with a CUDA device that no other has. Returns when bytes have gone between all
/// of them, which takes a second. Throws a simulation Error.
std::unique_ptr<NcclLinks> makeNcclLinks(std::shared_ptr<const NcclLibrary> nccl, Device& device, int rank,
                                         int ranks, const NcclUniqueId& id);

}  // namespace weir
