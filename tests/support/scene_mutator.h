// Makes wrong scene files out of right ones: typing mistakes, wrong types, huge numbers, cut files, cycles,
// and what else may reach a program that reads files. The same seed makes the same text on every machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/base/value.h"

namespace weir::test {

/// A small random generator (SplitMix64), the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  /// In [0, n); n > 0.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(next() % n); }
  bool chance(double p) { return static_cast<double>(next() >> 11) * 0x1p-53 < p; }
  template <class C>
  const auto& pick(const C& items) {
    return items[below(std::size(items))];
  }

 private:
  std::uint64_t state_;
};

class SceneMutator {
 public:
  /// Takes valid scenes as texts.
  explicit SceneMutator(const std::vector<std::string>& scenes);

  std::string mutate(std::uint64_t seed) const;

 private:
  std::vector<std::string> texts_;
  std::vector<Value> scenes_;
};

}  // namespace weir::test
