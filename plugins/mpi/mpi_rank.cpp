#include "plugins/mpi/mpi_rank.h"

#include <sys/prctl.h>

#include <limits>
#include <thread>

#include "framework/base/error.h"
#include "framework/communication/wait_limit.h"
#include "plugins/mpi/nccl_route.h"

namespace weir {

namespace {

Message take(MPI_Message& handle, const MPI_Status& status) {
  int bytes = 0;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  Message message(static_cast<std::size_t>(bytes));
  MPI_Mrecv(message.data(), bytes, MPI_BYTE, &handle, MPI_STATUS_IGNORE);
  return message;
}

}  // namespace

MpiRank::MpiRank() {
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &sizeHere_);
  MPI_Comm_free(&here);
  constexpr unsigned long kSlack = 1000;  // ns by which sleep may be longer, 50,000 otherwise
  ::prctl(PR_SET_TIMERSLACK, kSlack);
}

void MpiRank::post(Channel channel, int to, Message message) {
  forgetSent();
  if (message.size() > std::size_t(std::numeric_limits<int>::max()))
    throw simulationError("a message between ranks has more than 2 GiB", {}, "use more ranks");
  Sent& sent = sent_.emplace_back(std::move(message));
  MPI_Isend(sent.message.data(), static_cast<int>(sent.message.size()), MPI_BYTE, to, channel, MPI_COMM_WORLD,
            &sent.request);
}

Message MpiRank::receive(Channel channel, int from) {
  // Looking again and again is quickest, for a moment; whoever yields on a busy machine loses the core for
  // some milliseconds, and who sleeps is woken.
  constexpr std::chrono::microseconds kMoment{50};
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    int arrived = 0;
    MPI_Message handle = MPI_MESSAGE_NULL;
    MPI_Status status;
    MPI_Improbe(from, channel, MPI_COMM_WORLD, &arrived, &handle, &status);
    if (arrived != 0) return take(handle, status);
    lookForFailure();
    const Seconds passed = std::chrono::steady_clock::now() - start;
    if (limit_ && passed > *limit_) {
      dropParcels();
      throw waitedTooLong(from, *limit_);
    }
    if (passed > kMoment) std::this_thread::sleep_for(kMoment / 5);
  }
}

void MpiRank::lookForFailure() {
  int failed = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, kFailures, MPI_COMM_WORLD, &failed, MPI_STATUS_IGNORE);
  if (failed == 0) return;
  dropParcels();
  throw RanksEnded();
}

void MpiRank::dropParcels() noexcept {
  if (carrier_ != nullptr) carrier_->drop();
}

void MpiRank::postParcel(int to, Parcel parcel) {
  if (carrier_ != nullptr)
    carrier_->post(to, std::move(parcel));
  else
    Communicator::postParcel(to, std::move(parcel));
}

std::vector<Parcel> MpiRank::receiveParcels(std::span<const int> from, Device& device) {
  return carrier_ != nullptr ? carrier_->receive(from) : Communicator::receiveParcels(from, device);
}

std::unique_ptr<ParcelRoute> MpiRank::openRoute(Device& device) {
  return openNcclRoute(*this, device);
}

void MpiRank::setLimit() {
  limit_ = rankWaitLimit();
}

void MpiRank::tellOfFailure() {
  for (int to = 0; to < size_; ++to) {
    MPI_Request request = MPI_REQUEST_NULL;
    if (to != rank_) MPI_Isend(nullptr, 0, MPI_BYTE, to, kFailures, MPI_COMM_WORLD, &request);
    if (to != rank_) MPI_Request_free(&request);
  }
}

void MpiRank::finish() {
  for (Sent& sent : sent_) MPI_Wait(&sent.request, MPI_STATUS_IGNORE);
  sent_.clear();
}

void MpiRank::forgetSent() {
  sent_.remove_if([](Sent& sent) {
    int done = 0;
    MPI_Test(&sent.request, &done, MPI_STATUS_IGNORE);
    return done != 0;
  });
}

}  // namespace weir
