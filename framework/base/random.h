// Random numbers that a seed and an index decide, so that no order of calls, no thread and no back end can.
#pragma once

#include <cstdint>
#include <string_view>

#include "framework/base/api.h"
#include "framework/base/host_device.h"

namespace WEIR_API weir {

/// FNV-1a. Combined with a scene's seed it lets two nodes of the scene draw different numbers.
constexpr std::uint64_t hashOf(std::string_view text) {
  std::uint64_t h = 0xCBF29CE484222325ull;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
  return h;
}

/// The index-th number of SplitMix64 from this seed, counted from 0: any 64 bits.
WEIR_HD inline std::uint64_t splitMix64(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t x = seed + (index + 1) * 0x9E3779B97F4A7C15ull;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

/// A number in [-1, 1), by SplitMix64.
WEIR_HD inline double noise(std::uint64_t seed, std::uint64_t index) {
  return static_cast<double>(splitMix64(seed, index) >> 11) * 0x1p-52 - 1;
}

}  // namespace weir
