// Where the time goes: nested scopes (node, module, kernel) timed on the device they run on.
//
// On CUDA a scope is a pair of events that is resolved later, so timing never waits for the device; NVTX
// ranges carry the same names. On the CPU it is a clock.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// Totals of one scope, "water/solver/density".
struct ProfileEntry {
  std::string path;
  int depth = 0;  ///< 0 is a node
  std::uint64_t calls = 0;
  double totalMs = 0;
};

class Profiler {
 public:
  virtual ~Profiler() = default;

  /// Kernel scopes cost a little on CUDA, so they are timed only when asked for.
  void timeKernels(bool on) { timeKernels_ = on; }
  bool timesKernels() const { return timeKernels_; }

  virtual void push(std::string_view name) = 0;
  /// Never throws for a failing device, because scopes also close while an error travels.
  virtual void pop() = 0;
  /// The path of the scopes that are open now; errors quote it.
  virtual std::string currentPath() const = 0;

  /// Marks one step; stepMs() holds the device time of each finished step in order. In a step that is not
  /// `detailed`, scopes may go without times, so that all of it can be handed over at once (LaunchBatch).
  virtual void beginStep(bool detailed = true) = 0;
  virtual void endStep() = 0;

  /// Collects what the device has finished by now, without waiting for the rest.
  virtual void poll() = 0;
  /// Totals so far, in order of first appearance; those of the detailed steps stand for all. Waits for open
  /// measurements.
  virtual std::vector<ProfileEntry> entries() = 0;
  virtual std::vector<double> stepMs() = 0;
  virtual void clear() = 0;

 private:
  bool timeKernels_ = false;
};

/// Opens a scope for as long as it lives.
class ProfileScope {
 public:
  ProfileScope(Profiler& profiler, std::string_view name) : profiler_(profiler) { profiler_.push(name); }
  ~ProfileScope() { profiler_.pop(); }
  ProfileScope(const ProfileScope&) = delete;
  ProfileScope& operator=(const ProfileScope&) = delete;

 private:
  Profiler& profiler_;
};

/// The scope of one kernel: opened only if kernels are timed.
class KernelScope {
 public:
  KernelScope(Profiler& profiler, std::string_view name)
      : profiler_(profiler.timesKernels() ? &profiler : nullptr) {
    if (profiler_ != nullptr) profiler_->push(name);
  }
  ~KernelScope() {
    if (profiler_ != nullptr) profiler_->pop();
  }
  KernelScope(const KernelScope&) = delete;
  KernelScope& operator=(const KernelScope&) = delete;

 private:
  Profiler* profiler_;
};

}  // namespace weir
