#include "framework/compute/cpu_profiler.h"

#include "framework/base/check.h"

namespace weir {
namespace {

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void CpuProfiler::push(std::string_view name) {
  scopes_.open(name);
  started_.push_back(Clock::now());
}

void CpuProfiler::pop() {
  const int scope = scopes_.close();
  scopes_.add(scope, millisecondsSince(started_.back()));
  started_.pop_back();
}

// A step that an error ended never reaches endStep, so beginning again is allowed.
void CpuProfiler::beginStep(bool) {
  stepStarted_ = Clock::now();
}

void CpuProfiler::endStep() {
  WEIR_CHECK(stepStarted_.has_value());
  stepTimes_.add(millisecondsSince(*stepStarted_));
  stepStarted_.reset();
}

void CpuProfiler::clear() {
  scopes_.clear();
  stepTimes_.clear();
}

}  // namespace weir
