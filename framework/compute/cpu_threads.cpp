#include "framework/compute/cpu_threads.h"

#include <atomic>

#include "framework/base/interruption.h"

namespace weir {
namespace {

/// One call of run(). oneTBB orders what stands before the call, in it and behind it. The two atomics say so
/// once more, where the thread sanitizer can see it.
struct Call {
  void (*task)(void* context, std::int64_t k);
  void* context;
  std::atomic<bool> started{false};
  std::atomic<int> finished{0};

  static void runOne(void* self, std::int64_t k) {
    Call& call = *static_cast<Call*>(self);
    static_cast<void>(call.started.load(std::memory_order_acquire));
    struct Finish {
      std::atomic<int>& finished;
      ~Finish() { finished.fetch_add(1, std::memory_order_release); }
    } const finish{call.finished};  // also when the task throws
    call.task(call.context, k);
  }

  ~Call() { static_cast<void>(finished.load(std::memory_order_acquire)); }
};

}  // namespace

void CpuThreads::run(std::int64_t n, void (*task)(void* context, std::int64_t k), void* context) {
  InterruptibleWork::endIfAsked();
  Call call{.task = task, .context = context};
  call.started.store(true, std::memory_order_release);
  runUnordered(n, Call::runOne, &call);
}

}  // namespace weir
