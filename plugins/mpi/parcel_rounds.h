// Parcels between ranks, in rounds (Communicator), each of which is one exchange: all that a rank sends and
// receives in it goes at once.
//
// In a round a rank
//
// 1. tells the ranks to which it sends how large their parcels are,
// 2. waits until it is told the sizes of those that it receives,
// 3. gets memory for them, for which it may have to wait until its device has done all that it was asked for,
// 4. asks for the exchange, and goes on; its device does not go on before all has been sent and received.
//
// Ranks cannot wait for each other in a circle. Suppose that all rounds before the k-th come to their ends,
// and that each rank begins the k-th. What their devices were asked for before ends then, so no rank waits in
// 1 or 3 for ever; nor in 2, as each has told sizes before it waits for any. So all ask for the exchange, of
// which nobody waits for a part before another one, and round k ends. What ranks tell each other between
// rounds waits for no round that has not been asked for by all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/compute/parcel.h"

namespace weir {

class ParcelTransport {
 public:
  using Sizes = std::vector<std::int64_t>;      // bytes of each parcel
  using Batch = std::vector<Array<std::byte>>;  // what goes from one rank to another
  virtual ~ParcelTransport() = default;

  /// Tells a rank what it gets. Does not wait.
  virtual void announce(int to, const Sizes& sizes) = 0;
  /// What a rank sends. Waits until it is told; throws RanksEnded if a rank has failed.
  virtual Sizes announced(int from) = 0;
  /// Sends a batch to each rank and fills one from each, all at once. Arrays without bytes are left out. The
  /// host does not wait, but the device does: that is done between what it was asked for before and what it
  /// is asked for from now on.
  virtual void exchange(std::vector<Batch> toRanks, std::vector<Batch>& fromRanks) = 0;
};

class ParcelRounds {
 public:
  /// Both must outlive it. `device` is that of all parcels.
  ParcelRounds(ParcelTransport& transport, Device& device, int rank, int size);

  // As in Communicator.
  void post(int to, Parcel parcel);
  std::vector<Parcel> receive(std::span<const int> from);

 private:
  std::vector<ParcelTransport::Sizes> sizesFrom(std::span<const int> ranks);
  std::vector<ParcelTransport::Batch> roomFor(const std::vector<ParcelTransport::Sizes>& sizes);

  ParcelTransport& transport_;
  Device& device_;
  int rank_;
  std::vector<ParcelTransport::Batch> posted_;  // by rank
};

}  // namespace weir
