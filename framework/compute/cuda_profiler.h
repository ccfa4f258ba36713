// The profiler of the CUDA back end: pairs of events on the device's stream, resolved once both have passed.
#pragma once

#include <cuda_runtime.h>

#include <deque>
#include <vector>

#include "framework/compute/scope_tree.h"

namespace weir {

class CudaProfiler final : public Profiler {
 public:
  CudaProfiler(int deviceIndex, cudaStream_t stream) : deviceIndex_(deviceIndex), stream_(stream) {}
  ~CudaProfiler() override;

  void push(std::string_view name) override;
  void pop() override;
  std::string currentPath() const override { return scopes_.currentPath(); }
  void beginStep(bool detailed) override;
  void endStep() override;
  void poll() override;
  std::vector<ProfileEntry> entries() override;
  std::vector<double> stepMs() override;
  void clear() override;

 private:
  static constexpr int kStep = -1;  // stands for a scope in the measurement of a step

  struct Measurement {
    int scope;
    cudaEvent_t begin, end;
  };

  cudaEvent_t recordEvent();
  void discard(cudaEvent_t event);
  void finish(int scope, cudaEvent_t begin);
  void waitForAll();

  int deviceIndex_;
  cudaStream_t stream_;
  ScopeTree scopes_;
  std::vector<cudaEvent_t> begun_;  // of the open scopes
  cudaEvent_t stepBegun_ = nullptr;
  bool inStep_ = false;
  bool timesScopes_ = true;
  std::int64_t steps_ = 0, detailedSteps_ = 0;
  std::deque<Measurement> measuring_;  // in the order of their ends on the stream
  std::vector<cudaEvent_t> spare_;
  std::vector<double> stepMs_;
};

}  // namespace weir
