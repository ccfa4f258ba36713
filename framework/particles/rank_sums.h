// Sums and maxima over particles that several ranks may share.
//
//   sumOverRanks(device, "measure", {ranks, count}, Measure{…}, AddSums{}, sums.data());
//
// Where ranks share them, terms are added exactly (exact_sum.h), so every rank gets the same bits, and the
// same for any number of ranks. One that is alone adds doubles in the order of its particles, which is
// faster. All ranks make the same calls.
#pragma once

#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "framework/communication/communicator.h"
#include "framework/compute/exact_sum.h"
#include "framework/compute/key_lists.h"
#include "framework/compute/reduce_by_key.h"
#include "framework/compute/reductions.h"

namespace weir {

/// What is summed over: so many things of this rank, and those of the others.
struct OnAllRanks {
  Communicator* ranks = nullptr;  ///< null for one that is alone
  Count count;
  KeyListsView lists = {};  ///< for sums by key: which of these things belong to each, if somebody knows
};

namespace detail {

template <class Sums, class Of>
struct ExactTerm {
  Of of;
  double perUnit;
  WEIR_HD ExactSums<Sums> operator()(std::int64_t i) const { return {of(i), perUnit}; }
};

template <class Sums, class Of>
struct LargestTerm {
  Of of;
  WEIR_HD double operator()(std::int64_t i) const { return largestNumber(Sums(of(i))); }
};

/// What f gives (reduce_by_key.h), as exact terms.
template <class Sums, class F>
struct ExactByKey {
  F f;
  double perUnit;

  template <class Give>
  WEIR_HD void operator()(std::int64_t i, const Give& give) const {
    f(i, [&](int key, const auto& make) { give(key, [&] { return ExactSums<Sums>(make(), perUnit); }); });
  }
};

template <class F>
struct LargestByKey {
  F f;

  WEIR_HD double operator()(std::int64_t i) const {
    double largest = 0;
    f(i, [&](int, const auto& make) {
      const double found = largestNumber(make());
      if (found > largest) largest = found;
    });
    return largest;
  }
};

/// The sums of all ranks, of which each has as many.
template <class Sums>
std::vector<ExactSums<Sums>> gatheredSums(Communicator& ranks, const std::vector<ExactSums<Sums>>& own) {
  const auto bytes = std::as_bytes(std::span(own));
  std::vector<ExactSums<Sums>> all(own.size()), some(own.size());
  for (const Message& message : ranks.allGather(Message(bytes.begin(), bytes.end()))) {
    const bool ranksHaveAsMany = message.size() == bytes.size();
    WEIR_CHECK(ranksHaveAsMany);
    if (!message.empty()) std::memcpy(static_cast<void*>(some.data()), message.data(), message.size());
    for (std::size_t key = 0; key < all.size(); ++key) all[key] += some[key];
  }
  return all;
}

/// Writes what all ranks have found, in that unit, to the device.
template <class Sums>
void writeGathered(Device& device, Communicator& ranks, const Array<ExactSums<Sums>>& own, double unit,
                   Sums* to) {
  std::vector<Sums> values;
  for (const ExactSums<Sums>& sum : gatheredSums(ranks, own.toHost())) values.push_back(sum.value(unit));
  if (!values.empty()) device.upload(to, values.data(), values.size() * sizeof(Sums));
}

}  // namespace detail

/// One number, which each rank has on the device, becomes the largest of all.
template <class T>
void maxOverRanks(Communicator* ranks, Array<T>& number) {
  if (ranks == nullptr) return;
  const T max = ranks->max(number.toHost().front());
  number.device().upload(number.data(), &max, sizeof(max));
}

/// A power of two near the largest of(i), which is at least 0; 1 if all are 0.
template <class Backend, class Of>
double unitOnRanks(Backend& device, std::string_view name, const OnAllRanks& all, const Of& of) {
  Array<double> largest(device, 1);
  reduce(device, name, all.count, 0.0, of, Max{}, largest.data());
  maxOverRanks(all.ranks, largest);
  const double found = largest.toHost().front();
  return found > 0 ? powerBelow(found) : 1;
}

/// *to, on the device, = the sum by `add` of of(i). `unit` is about what scaled terms are: exact sums leave
/// out what is below 2^-62 of it, and terms have at most 2^31 of it.
template <class Backend, class Of, class Add, class Sums>
void sumOverRanks(Backend& device, std::string_view name, const OnAllRanks& all, double unit, const Of& of,
                  const Add& add, Sums* to) {
  if (all.ranks == nullptr) return reduce(device, name, all.count, Sums{}, of, add, to);
  const double binary = powerBelow(unit);
  Array<ExactSums<Sums>> own(device, 1);
  reduce(device, name, all.count, ExactSums<Sums>{}, detail::ExactTerm<Sums, Of>{of, 1 / binary}, Plus{},
         own.data());
  detail::writeGathered(device, *all.ranks, own, binary, to);
}

/// The same for terms of which nobody knows how large they are: they are looked at first, so of(i) is asked
/// twice.
template <class Backend, class Of, class Add, class Sums>
void sumOverRanks(Backend& device, std::string_view name, const OnAllRanks& all, const Of& of, const Add& add,
                  Sums* to) {
  if (all.ranks == nullptr) return reduce(device, name, all.count, Sums{}, of, add, to);
  const double unit = unitOnRanks(device, name, all, detail::LargestTerm<Sums, Of>{of});
  sumOverRanks(device, name, all, unit, of, add, to);
}

namespace detail {

template <class Backend, class T, class F, class Op>
void reduceByKeyOrList(Backend& device, std::string_view name, const OnAllRanks& all, std::int64_t keys,
                       T identity, const F& f, const Op& op, T* results) {
  if (all.lists.first.size > 0) return reduceListed(device, name, all.lists, identity, f, op, results);
  reduceByKey(device, name, all.count, keys, identity, f, op, results);
}

}  // namespace detail

/// reduceByKey() over all ranks, or reduceListed() where there are lists; f may be asked twice for an i.
template <class Sums, class Backend, class F, class Add>
void sumByKeyOverRanks(Backend& device, std::string_view name, const OnAllRanks& all, std::int64_t keys,
                       const F& f, const Add& add, Sums* results) {
  if (all.ranks == nullptr)
    return detail::reduceByKeyOrList(device, name, all, keys, Sums{}, f, add, results);
  const double unit = unitOnRanks(device, name, all, detail::LargestByKey<F>{f});
  Array<ExactSums<Sums>> own(device, keys);
  detail::reduceByKeyOrList(device, name, all, keys, ExactSums<Sums>{},
                            detail::ExactByKey<Sums, F>{f, 1 / unit}, Plus{}, own.data());
  detail::writeGathered(device, *all.ranks, own, unit, results);
}

}  // namespace weir
