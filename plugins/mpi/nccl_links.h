// The GPU's side of parcels by NCCL. Two communicators, as parcel_batches.h says why, each with a stream of
// its own beside the device's: those wait for each other by events, and the host for none.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "framework/compute/array.h"
#include "plugins/mpi/nccl_library.h"

namespace weir {

/// What tells GPUs apart, on all machines. Of a CUDA device.
using GpuId = std::array<std::byte, 16>;
GpuId gpuIdOf(const Device& device);

/// Of a communicator from lower to higher ranks, and of one from higher to lower ones.
using NcclIds = std::array<NcclUniqueId, 2>;
NcclIds makeNcclIds(const NcclLibrary& nccl);

class NcclLinks {
 public:
  using Batch = std::vector<Array<std::byte>>;
  virtual ~NcclLinks() = default;

  // As in ParcelTransport.
  virtual void mark() = 0;
  virtual void send(std::vector<Batch> toRanks) = 0;
  virtual void receive(int from, std::span<Array<std::byte>> into) = 0;

  /// Whether all that was sent has gone.
  virtual bool areIdle() = 0;
  /// Once nothing is on its way between any ranks, which all call it.
  virtual void close() = 0;
  /// Gives up what is on its way, unless it goes within a second. The destructor does so, too.
  virtual void drop() noexcept = 0;
};

/// All ranks take part, each with a CUDA device that no other has. Returns when bytes have gone between all
/// of them, which takes a second. Throws a simulation Error.
std::unique_ptr<NcclLinks> makeNcclLinks(std::shared_ptr<const NcclLibrary> nccl, Device& device, int rank,
                                         int ranks, const NcclIds& ids);

}  // namespace weir
