// Ranks: several that share a run, each with a part of its particles, and what they tell each other.
//
//   ranks.post(neighbour, std::move(packed));             // goes on at once
//   ...
//   const std::vector<std::byte> theirs = ranks.receive(neighbour);
//
// What all ranks take part in must be called by all of them, in the same order. Sums are of integers, whose
// order does not matter, so all results are the same bits for any number of ranks (see exact_sum.h for the
// sums of other numbers).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <span>
#include <type_traits>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/parcel.h"

namespace WEIR_API weir {

using Message = std::vector<std::byte>;

/// Thrown where a rank waits for another while one has failed. Whoever runs the ranks knows that one's error.
class RanksEnded final : public std::exception {
 public:
  const char* what() const noexcept override { return "another rank has failed"; }
};

class Communicator {
 public:
  virtual ~Communicator() = default;

  virtual int rank() const = 0;  ///< from 0
  virtual int size() const = 0;  ///< how many there are
  /// How many of them share this machine.
  virtual int sizeHere() const = 0;

  /// Sends a message to a rank, which may be this one. Does not wait.
  virtual void post(int to, Message message) = 0;
  /// The next message of a rank to this one, in the order in which it posted them. Waits for it; throws
  /// RanksEnded if a rank has failed.
  virtual Message receive(int from) = 0;

  // All ranks take part in these.
  /// Parcels, which are bytes on devices, go in rounds: a rank posts what it has for others, and ends the
  /// round by receiving what they have for it. They go by way of the hosts, unless the ranks share a process
  /// or a back end knows a better one. Does not wait.
  virtual void postParcel(int to, Parcel parcel) { post(to, parcel.toHost()); }
  /// One parcel of each of these ranks, which may be none; where a rank has posted several in this round, it
  /// is named as often, and they come in their order. Whoever neither sends nor receives ends the round, too.
  virtual std::vector<Parcel> receiveParcels(std::span<const int> from, Device& device);
  /// What each rank has given, by rank.
  std::vector<Message> allGather(const Message& mine);
  template <class T>
  std::vector<T> allGather(const T& mine);
  /// Every element becomes its sum over the ranks, which must have as many.
  void sum(std::span<std::int64_t> values);
  std::int64_t sum(std::int64_t value) {
    sum(std::span(&value, 1));
    return value;
  }
  /// The largest of all.
  template <class T>
  T max(T value);
  bool any(bool value) { return sum(value ? 1 : 0) > 0; }
};

template <class T>
std::vector<T> Communicator::allGather(const T& mine) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* bytes = reinterpret_cast<const std::byte*>(&mine);
  std::vector<T> all;
  for (const Message& one : allGather(Message(bytes, bytes + sizeof(T))))
    std::memcpy(&all.emplace_back(mine), one.data(), sizeof(T));
  return all;
}

template <class T>
T Communicator::max(T value) {
  for (const T& other : allGather(value))
    if (other > value) value = other;
  return value;
}

}  // namespace weir
