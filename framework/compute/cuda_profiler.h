// The profiler of the CUDA back end: pairs of events on the device's stream, resolved once both have passed.
#pragma once

#include <cuda_runtime.h>

#include <deque>
#include <memory>
#include <vector>

#include "framework/compute/scope_tree.h"
#include "framework/compute/step_times.h"

namespace weir {

class CudaProfiler final : public Profiler, public TimesSteps {
 public:
  CudaProfiler(int deviceIndex, cudaStream_t stream) : deviceIndex_(deviceIndex), stream_(stream) {}
  ~CudaProfiler() override;

  void push(std::string_view name) override;
  void pop() override;
  std::string currentPath() const override { return scopes_.currentPath(); }
  int currentScope() const { return scopes_.current(); }
  /// "" for -1.
  std::string pathOf(int scope) const { return scopes_.pathOf(scope); }
  void beginStep(bool detailed) override;
  void endStep() override;
  void poll() override;
  std::vector<ProfileEntry> entries() override;
  std::vector<double> stepMs() override;
  void clear() override;

  /// The device is asked for something. What it is asked between two steps lies in neither of them, nor does
  /// a pause. Where there is neither, the second begins with the event that ended the first, as each holds up
  /// the device for a microsecond.
  void noteWork() {
    if (!inStep_) stepEnded_ = nullptr;
  }

 private:
  static constexpr int kStep = -1;  // stands for a scope in the measurement of a step

  // Used again when nobody holds it.
  using Event = std::shared_ptr<CUevent_st>;

  struct Measurement {
    int scope;
    Event begin, end;
  };

  Event recordEvent();
  void finish(int scope, const Event& begin, const Event& end);
  void waitForAll();

  int deviceIndex_;
  cudaStream_t stream_;
  ScopeTree scopes_;
  std::vector<cudaEvent_t> spare_;  // outlives all that holds events
  std::vector<Event> begun_;        // of the open scopes
  Event stepBegun_, stepEnded_;
  bool inStep_ = false;
  bool timesScopes_ = true;
  std::int64_t steps_ = 0, detailedSteps_ = 0;
  std::deque<Measurement> measuring_;  // in the order of their ends on the stream
};

}  // namespace weir
