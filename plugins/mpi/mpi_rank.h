// A rank of an MPI launch. Messages travel by host memory, so any MPI does; so do parcels, unless a route is
// open (nccl_route.h).
#pragma once

#include <mpi.h>

#include <chrono>
#include <list>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "framework/communication/communicator.h"
#include "framework/communication/parcel_route.h"

namespace weir {

/// What takes a rank's parcels in its place while it is set.
class ParcelCarrier {
 public:
  virtual ~ParcelCarrier() = default;
  virtual void post(int to, Parcel parcel) = 0;
  virtual std::vector<Parcel> receive(std::span<const int> from) = 0;
  /// Before an error travels, as what waits for the device on its way could wait for ever.
  virtual void drop() noexcept = 0;
};

class MpiRank final : public Communicator, public ParcelRoutes {
 public:
  /// Apart from each other, in order.
  enum Channel : int { kMessages = 1, kFailures = 2, kParcelSizes = 3 };
  using Seconds = std::chrono::duration<double>;

  MpiRank();

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int sizeHere() const override { return sizeHere_; }
  void post(int to, Message message) override { post(kMessages, to, std::move(message)); }
  Message receive(int from) override { return receive(kMessages, from); }
  void postParcel(int to, Parcel parcel) override;
  std::vector<Parcel> receiveParcels(std::span<const int> from, Device& device) override;
  std::unique_ptr<ParcelRoute> openRoute(Device& device) override;

  void post(Channel channel, int to, Message message);
  Message receive(Channel channel, int from);
  /// Until it is taken from here again, by null.
  void setCarrier(ParcelCarrier* carrier) { carrier_ = carrier; }
  /// Throws RanksEnded if another rank has failed.
  void lookForFailure();

  /// Of the environment variable; its Error ends all ranks, as they are there.
  void setLimit();
  /// Tells all others that this rank goes no further.
  void tellOfFailure();
  /// Until everything that was posted has been taken.
  void finish();

 private:
  /// What must stay until it is on its way.
  struct Sent {
    explicit Sent(Message of) : message(std::move(of)) {}
    Message message;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  void dropParcels() noexcept;
  void forgetSent();

  int rank_ = 0, size_ = 1, sizeHere_ = 1;
  std::optional<Seconds> limit_;
  std::list<Sent> sent_;
  ParcelCarrier* carrier_ = nullptr;
};

}  // namespace weir
