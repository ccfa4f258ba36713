// What is done to the processes of a launch while they run.
#pragma once

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/support/child_process.h"

namespace weir::test {

/// Process ids.
inline std::vector<int> childrenOf(int pid) {
  const std::string of = "/proc/" + std::to_string(pid);
  std::ifstream file(of + "/task/" + std::to_string(pid) + "/children");
  return {std::istream_iterator<int>(file), {}};
}

/// Runs `during` again and again on a thread of its own, with the process id of mpirun, until it returns
/// true.
class Meanwhile {
 public:
  explicit Meanwhile(std::function<bool(int launcher)> during)
      : during_(std::move(during)), thread_([this](const std::stop_token& stop) {
          while (!stop.stop_requested() && (launcher_ == 0 || !during_(launcher_)))
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }) {}
  ChildOptions options() {
    ChildOptions options;
    options.onStderr = [this](int pid, const std::string&) { launcher_ = pid; };
    return options;
  }

 private:
  std::function<bool(int)> during_;
  std::atomic<int> launcher_ = 0;
  std::jthread thread_;
};

}  // namespace weir::test
