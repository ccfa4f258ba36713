#include "plugins/mpi/parcel_rounds.h"

#include <bit>
#include <utility>

#include "framework/base/check.h"

namespace weir {

namespace {

using Batch = ParcelTransport::Batch;
using Sizes = ParcelTransport::Sizes;

/// Of a few sizes only, so that the pool need not ask the system for memory in most rounds.
Array<std::byte> arrayOf(Device& device, std::int64_t bytes) {
  constexpr std::int64_t kMuch = std::int64_t{1} << 26;
  Array<std::byte> array(device);
  array.reserveDiscarding(bytes > kMuch ? bytes : std::int64_t(std::bit_ceil(std::uint64_t(bytes))));
  array.resizeDiscarding(bytes);
  return array;
}

Sizes sizesOf(const Batch& batch) {
  Sizes sizes;
  for (const Array<std::byte>& one : batch) sizes.push_back(one.size());
  return sizes;
}

std::vector<Parcel> inOrder(std::span<const int> from, std::vector<Batch> received) {
  std::vector<std::size_t> taken(received.size());
  std::vector<Parcel> parcels;
  for (const int rank : from) {
    const std::size_t k = std::size_t(rank);
    parcels.emplace_back(std::move(received[k][taken[k]++]));
  }
  return parcels;
}

}  // namespace

ParcelRounds::ParcelRounds(ParcelTransport& transport, Device& device, int rank, int size)
    : transport_(transport), device_(device), rank_(rank), posted_(std::size_t(size)) {}

void ParcelRounds::post(int to, Parcel parcel) {
  const bool isForAnother = to != rank_;
  WEIR_CHECK(isForAnother);
  posted_[std::size_t(to)].push_back(std::move(parcel).release());
}

std::vector<Parcel> ParcelRounds::receive(std::span<const int> from) {
  std::vector<Batch> sent = std::exchange(posted_, std::vector<Batch>(posted_.size()));
  for (std::size_t to = 0; to < sent.size(); ++to)
    if (!sent[to].empty()) transport_.announce(static_cast<int>(to), sizesOf(sent[to]));
  std::vector<Batch> received = roomFor(sizesFrom(from));
  transport_.exchange(std::move(sent), received);
  return inOrder(from, std::move(received));
}

/// By rank.
std::vector<Sizes> ParcelRounds::sizesFrom(std::span<const int> ranks) {
  std::vector<std::size_t> expected(posted_.size());
  for (const int rank : ranks) ++expected[std::size_t(rank)];
  std::vector<Sizes> sizes(posted_.size());
  for (std::size_t rank = 0; rank < expected.size(); ++rank) {
    if (expected[rank] == 0) continue;
    sizes[rank] = transport_.announced(static_cast<int>(rank));
    const bool othersMakeTheSameCalls = sizes[rank].size() == expected[rank];
    WEIR_CHECK(othersMakeTheSameCalls);
  }
  return sizes;
}

std::vector<Batch> ParcelRounds::roomFor(const std::vector<Sizes>& sizes) {
  std::vector<Batch> room(sizes.size());
  for (std::size_t rank = 0; rank < sizes.size(); ++rank)
    for (const std::int64_t bytes : sizes[rank]) room[rank].push_back(arrayOf(device_, bytes));
  return room;
}

}  // namespace weir
