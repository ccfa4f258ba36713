#include "plugins/mpi/parcel_batches.h"

#include <bit>
#include <utility>

#include "framework/base/check.h"

namespace weir {

namespace {

/// Of a few sizes only, so that the pool need not ask the system for memory; giving some back to it waits for
/// all that the device is at.
Array<std::byte> arrayOf(Device& device, std::int64_t bytes) {
  constexpr std::int64_t kMuch = std::int64_t{1} << 26;
  Array<std::byte> array(device);
  array.reserveDiscarding(bytes > kMuch ? bytes : std::int64_t(std::bit_ceil(std::uint64_t(bytes))));
  array.resizeDiscarding(bytes);
  return array;
}

}  // namespace

ParcelBatches::ParcelBatches(ParcelTransport& transport, Device& device, int rank, int size)
    : transport_(transport),
      device_(device),
      rank_(rank),
      posted_(std::size_t(size)),
      arrived_(std::size_t(size)) {}

/// A copy is sent, which is made at once: parcels do not tell where their bytes are.
void ParcelBatches::post(int to, Parcel parcel) {
  if (to == rank_) {
    arrived_[std::size_t(to)].push_back(std::move(parcel));
    return;
  }
  // Whoever receives needs room for all of a batch.
  constexpr std::int64_t kMuch = std::int64_t{1} << 28;
  if (!posted_[std::size_t(to)].empty() && bytesPosted_ + parcel.size() > kMuch) flush();
  bytesPosted_ += parcel.size();
  parcel.copyTo(device_, posted_[std::size_t(to)].emplace_back(arrayOf(device_, parcel.size())).data());
  transport_.mark();
}

Parcel ParcelBatches::take(int from) {
  std::deque<Parcel>& arrived = arrived_[std::size_t(from)];
  if (!arrived.empty())
    flush();
  else
    fetch(from);
  const bool othersMakeTheSameCalls = !arrived.empty();
  WEIR_CHECK(othersMakeTheSameCalls);
  Parcel next = std::move(arrived.front());
  arrived.pop_front();
  return next;
}

void ParcelBatches::flush() {
  if (announce()) send();
}

bool ParcelBatches::announce() {
  bool any = false;
  for (std::size_t to = 0; to < posted_.size(); ++to) {
    if (posted_[to].empty()) continue;
    ParcelTransport::Sizes sizes;
    for (const Array<std::byte>& one : posted_[to]) sizes.push_back(one.size());
    transport_.announce(static_cast<int>(to), sizes);
    any = true;
  }
  return any;
}

void ParcelBatches::send() {
  bytesPosted_ = 0;
  transport_.send(std::exchange(posted_, std::vector<ParcelTransport::Batch>(posted_.size())));
}

/// Memory is taken before anything is sent, if the other rank is about to send as well: where that has to
/// wait for the device, and sending waits for the other rank, both could wait for ever. Where it waits for
/// what is sent here, it would never announce anything.
void ParcelBatches::fetch(int from) {
  constexpr ParcelTransport::Seconds kPatience{0.002};
  bool mustSend = announce();
  std::optional<ParcelTransport::Sizes> sizes;
  if (mustSend) {
    sizes = transport_.announced(from, kPatience);
    if (!sizes) send(), mustSend = false;
  }
  if (!sizes) sizes = transport_.announced(from, std::nullopt);
  std::vector<Array<std::byte>> arrays;
  for (const std::int64_t bytes : *sizes) arrays.push_back(arrayOf(device_, bytes));
  if (mustSend) send();
  transport_.receive(from, arrays);
  for (Array<std::byte>& one : arrays) arrived_[std::size_t(from)].emplace_back(std::move(one));
}

}  // namespace weir
