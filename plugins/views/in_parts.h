// Work of the host that is divided among its cores, where no device of the run does it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "framework/compute/cpu_threads.h"

namespace weir::rendering {

/// Calls task(begin, end) for parts that make up [0, n), on all cores at once if there is enough to do;
/// throws what a task throws.
template <class Task>
void inParts(std::size_t n, const Task& task) {
  constexpr std::size_t kPart = 4096;  // worth handing over
  const auto part = [&](std::size_t k) { task(k * kPart, std::min(n, (k + 1) * kPart)); };
  const std::size_t parts = (n + kPart - 1) / kPart;
  CpuThreads(0).run(
      static_cast<std::int64_t>(parts),
      [](void* context, std::int64_t k) {
        (*static_cast<decltype(&part)>(context))(static_cast<std::size_t>(k));
      },
      const_cast<void*>(static_cast<const void*>(&part)));
}

}  // namespace weir::rendering
