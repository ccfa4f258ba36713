// Parcels between ranks, in batches: what a rank has for others is sent as a whole when it first waits, and
// comes as a whole.
//
// A rank first tells each of the others the sizes of what comes, and then sends. Bytes may go where sending
// ends once the other rank receives, in the order in which both were asked for. So that no ranks wait for
// each other in a circle, one lane has all that goes from lower to higher ranks and another all that goes
// from higher to lower ones. With one lane for both, three ranks that all send to all would: 0 sends to 1 and
// 2, and is behind with receiving what 1 sends, behind which 1 is with receiving from 0. It takes that all
// ranks exchange in the same rounds: each sends first and then receives, and all of them receive from lower
// ranks first, or all from higher ones.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "framework/compute/parcel.h"

namespace weir {

class ParcelTransport {
 public:
  using Sizes = std::vector<std::int64_t>;      // bytes of each parcel of a batch
  using Batch = std::vector<Array<std::byte>>;  // what is sent to one rank
  using Seconds = std::chrono::duration<double>;
  virtual ~ParcelTransport() = default;

  /// Tells a rank what will come. Does not wait.
  virtual void announce(int to, const Sizes& sizes) = 0;
  /// What the next batch of a rank has. Waits for it, at most that long; throws RanksEnded if a rank has
  /// failed.
  virtual std::optional<Sizes> announced(int from, std::optional<Seconds> patience) = 0;

  /// What the device was asked for so far comes before the next send().
  virtual void mark() = 0;
  /// Sends a batch to each rank, in one go, and does not wait. Arrays without bytes are left out.
  virtual void send(std::vector<Batch> toRanks) = 0;
  /// Fills arrays with a batch, without those that have no bytes; what the device is asked for from now on
  /// comes after that.
  virtual void receive(int from, std::span<Array<std::byte>> into) = 0;
};

class ParcelBatches {
 public:
  /// Both must outlive it. `device` is that of all parcels.
  ParcelBatches(ParcelTransport& transport, Device& device, int rank, int size);

  void post(int to, Parcel parcel);
  /// The next parcel of a rank, in the order in which it posted them; sends what was posted.
  Parcel take(int from);
  /// Sends what was posted.
  void flush();

 private:
  bool announce();
  void send();
  void fetch(int from);

  ParcelTransport& transport_;
  Device& device_;
  int rank_;
  std::vector<ParcelTransport::Batch> posted_;  // by rank
  std::int64_t bytesPosted_ = 0;
  std::vector<std::deque<Parcel>> arrived_;  // by rank, of batches that were taken in part
};

}  // namespace weir
