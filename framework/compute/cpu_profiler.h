// The profiler of the CPU back end: work is done when a call returns, so a clock is enough.
#pragma once

#include <chrono>
#include <optional>

#include "framework/compute/scope_tree.h"
#include "framework/compute/step_times.h"

namespace weir {

class CpuProfiler final : public Profiler, public TimesSteps {
 public:
  void push(std::string_view name) override;
  void pop() override;
  std::string currentPath() const override { return scopes_.currentPath(); }
  void beginStep(bool detailed) override;
  void endStep() override;
  void poll() override {}
  std::vector<ProfileEntry> entries() override { return scopes_.entries(); }
  std::vector<double> stepMs() override { return stepTimes_.kept(); }
  void clear() override;

 private:
  using Clock = std::chrono::steady_clock;

  ScopeTree scopes_;
  std::vector<Clock::time_point> started_;  // of the open scopes
  std::optional<Clock::time_point> stepStarted_;
};

}  // namespace weir
