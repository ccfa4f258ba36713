// What a scene will hold in memory, told before it is made, so that a scene too large for it is refused at
// once.
//
// Every node tells what it needs in Node::estimate(), from the first node to the last: a source how many
// particles it brings, a fluid what that many particles take. These are upper bounds, from the same sizes by
// which arrays are allocated.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/error.h"
#include "framework/compute/array.h"
#include "framework/compute/memory_pool.h"

namespace WEIR_API weir {

/// What an array of that many elements takes of a device, in bytes; in double, as it may be absurdly much.
inline double bytesOfArray(double elements, std::size_t elementSize) {
  const double bytes = elements * static_cast<double>(elementSize);
  constexpr double kExact = 1e18;
  return bytes < kExact ? static_cast<double>(MemoryPool::sizeClass(static_cast<std::size_t>(bytes))) : bytes;
}

/// What these arrays take with that many elements each.
template <class... T>
double bytesOfArrays(double elements, const Array<T>&...) {
  return (bytesOfArray(elements, sizeof(T)) + ... + 0.0);
}

/// Of one node, in bytes.
struct MemoryNeeds {
  double device = 0;  ///< at most, on the device
  /// What it surely comes to; less than `device` where particles may be removed before others are born.
  double certain = 0;
  double host = 0;       ///< in the host's memory while it is reset, where that is not the device's
  double particles = 0;  ///< that it holds at most
  /// What a user may change so that all this becomes the given share, in (0, 1): "a spacing of at least 0.02
  /// m".
  std::function<std::string(double share)> remedy;

  void add(double bytes) { device += bytes, certain += bytes; }
};

class MemoryEstimate {
 public:
  struct Entry {
    std::string node;
    MemoryNeeds needs;
  };

  void add(std::string node, MemoryNeeds needs) { entries_.push_back({std::move(node), std::move(needs)}); }
  const std::vector<Entry>& entries() const { return entries_; }
  /// Sums over all nodes.
  MemoryNeeds total() const;

  /// Throws a scene Error, with what is needed, what there is and what would fit, if what is certain does not
  /// fit. `available` in bytes, 0 if it is unknown. Returns a warning if only what may be needed does not, or
  /// "".
  std::string check(double available, const std::string& device) const;
  /// The same for the host's memory, where the device has its own.
  void checkHost(double available) const;

 private:
  Error tooMuch(double needed, double available, const std::string& where) const;
  std::string remedyFor(double available) const;

  std::vector<Entry> entries_;
};

/// "3.4 GiB".
std::string shortBytes(double bytes);

}  // namespace weir
