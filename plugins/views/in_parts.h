// Work of the host that is divided among threads, for who has no device to do it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace weir::rendering {

/// Calls task(begin, end) for parts that make up [0, n), on all cores at once if there is enough to do. Ends
/// when all have ended; tasks must not throw.
template <class Task>
void inParts(std::size_t n, const Task& task) {
  constexpr std::size_t kLeast = 4096;  // worth a thread
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t parts = std::clamp<std::size_t>(n / kLeast, 1, cores);
  std::vector<std::jthread> threads;
  for (std::size_t k = 1; k < parts; ++k)
    threads.emplace_back([&task, n, k, parts] { task(n * k / parts, n * (k + 1) / parts); });
  task(0, n / parts);
}

}  // namespace weir::rendering
