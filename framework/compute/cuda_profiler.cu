#include "framework/compute/cuda_profiler.h"

#include "framework/base/check.h"

#if __has_include(<nvtx3/nvToolsExt.h>)
#include <nvtx3/nvToolsExt.h>
#define WEIR_HAS_NVTX
#endif

// A failing event loses a measurement and nothing else: whatever broke the device is reported by the next
// launch or copy, with its name. So failures are not thrown here, and null stands for an event that failed.

namespace weir {
namespace {

void beginRange([[maybe_unused]] std::string_view name) {
#ifdef WEIR_HAS_NVTX
  nvtxRangePushA(std::string(name).c_str());
#endif
}

void endRange() {
#ifdef WEIR_HAS_NVTX
  nvtxRangePop();
#endif
}

/// Whether `event` has passed; an event that failed counts as passed.
bool hasPassed(cudaEvent_t event) {
  const cudaError_t state = cudaEventQuery(event);
  if (state != cudaErrorNotReady) return true;
  static_cast<void>(cudaGetLastError());  // "not ready" must not show up as the error of the next launch
  return false;
}

}  // namespace

CudaProfiler::~CudaProfiler() {
  static_cast<void>(cudaSetDevice(deviceIndex_));
  clear();
  begun_.clear();
  stepBegun_ = stepEnded_ = nullptr;
  for (cudaEvent_t event : spare_) static_cast<void>(cudaEventDestroy(event));
}

CudaProfiler::Event CudaProfiler::recordEvent() {
  if (cudaSetDevice(deviceIndex_) != cudaSuccess) return nullptr;
  cudaEvent_t event = nullptr;
  if (spare_.empty()) {
    if (cudaEventCreate(&event) != cudaSuccess) return nullptr;
  } else {
    event = spare_.back();
    spare_.pop_back();
  }
  Event held(event, [this](cudaEvent_t unused) { spare_.push_back(unused); });
  return cudaEventRecord(event, stream_) == cudaSuccess ? held : nullptr;
}

void CudaProfiler::finish(int scope, const Event& begin, const Event& end) {
  if (begin != nullptr && end != nullptr) measuring_.push_back({scope, begin, end});
}

void CudaProfiler::push(std::string_view name) {
  scopes_.open(name);
  beginRange(name);
  begun_.push_back(timesScopes_ ? recordEvent() : nullptr);
}

void CudaProfiler::pop() {
  const int scope = scopes_.close();
  finish(scope, begun_.back(), begun_.back() != nullptr ? recordEvent() : nullptr);
  begun_.pop_back();
  endRange();
}

// A step that an error ended never reaches endStep, so beginning again is allowed.
void CudaProfiler::beginStep(bool detailed) {
  const bool follows = stepEnded_ != nullptr && !hasPassed(stepEnded_.get());
  stepBegun_ = follows ? stepEnded_ : recordEvent();
  stepEnded_ = nullptr;
  inStep_ = true;
  timesScopes_ = detailed;
}

void CudaProfiler::endStep() {
  WEIR_CHECK(inStep_);
  stepEnded_ = recordEvent();
  finish(kStep, stepBegun_, stepEnded_);
  stepBegun_ = nullptr;
  inStep_ = false;
  ++steps_;
  if (timesScopes_) ++detailedSteps_;
  timesScopes_ = true;
  poll();
}

void CudaProfiler::poll() {
  while (!measuring_.empty() && hasPassed(measuring_.front().end.get())) {
    const Measurement done = measuring_.front();
    measuring_.pop_front();
    float ms = 0;
    if (cudaEventElapsedTime(&ms, done.begin.get(), done.end.get()) == cudaSuccess) {
      if (done.scope == kStep) {
        stepTimes_.add(ms);
      } else {
        scopes_.add(done.scope, ms);
      }
    }
  }
}

void CudaProfiler::waitForAll() {
  if (!measuring_.empty()) static_cast<void>(cudaEventSynchronize(measuring_.back().end.get()));
  poll();
}

std::vector<ProfileEntry> CudaProfiler::entries() {
  waitForAll();
  return scopes_.entries(detailedSteps_ > 0 ? double(steps_) / double(detailedSteps_) : 1.0);
}

std::vector<double> CudaProfiler::stepMs() {
  waitForAll();
  return stepTimes_.kept();
}

void CudaProfiler::clear() {
  measuring_.clear();
  scopes_.clear();
  stepTimes_.clear();
  steps_ = detailedSteps_ = 0;
}

}  // namespace weir
