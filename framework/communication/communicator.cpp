#include "framework/communication/communicator.h"

#include "framework/base/check.h"

namespace weir {

std::vector<Message> Communicator::allGather(const Message& mine) {
  for (int to = 0; to < size(); ++to) post(to, mine);
  std::vector<Message> all;
  for (int from = 0; from < size(); ++from) all.push_back(receive(from));
  return all;
}

std::vector<Parcel> Communicator::receiveParcels(std::span<const int> from, Device& device) {
  std::vector<Parcel> parcels;
  for (const int rank : from) parcels.emplace_back(Array<std::byte>(device, receive(rank)));
  return parcels;
}

void Communicator::sum(std::span<std::int64_t> values) {
  const auto bytes = std::as_bytes(values);
  const std::vector<Message> all = allGather(Message(bytes.begin(), bytes.end()));
  for (std::int64_t& value : values) value = 0;
  for (const Message& one : all) {
    const bool ranksHaveAsMany = one.size() == values.size_bytes();
    WEIR_CHECK(ranksHaveAsMany);
    for (std::size_t k = 0; k < values.size(); ++k) {
      std::int64_t term = 0;
      std::memcpy(&term, one.data() + k * sizeof(term), sizeof(term));
      values[k] += term;
    }
  }
}

}  // namespace weir
