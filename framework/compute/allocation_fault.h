// For tests of what a run does where a device has no memory left.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <utility>

#include "framework/compute/memory_pool.h"

namespace weir {

/// The same, but for the block that WEIR_TEST_FAIL_ALLOCATION numbers in the environment: from 1 on, of those
/// that a device asks the system for. That one cannot be had, nor when the pool asks again for it.
inline MemoryPool::Allocate withFault(MemoryPool::Allocate allocate) {
  const char* number = std::getenv("WEIR_TEST_FAIL_ALLOCATION");
  const std::int64_t failing = number != nullptr ? std::strtoll(number, nullptr, 10) : 0;
  if (failing <= 0) return allocate;
  return [allocate = std::move(allocate), failing, asked = std::int64_t{0}](std::size_t bytes) mutable {
    ++asked;
    return asked == failing || asked == failing + 1 ? nullptr : allocate(bytes);
  };
}

}  // namespace weir
