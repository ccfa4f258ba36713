#include "apps/studio/session/past_run.h"

#include <new>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/error.h"

namespace weir::studio {

PastRun::PastRun(const Registry& registry, int threads, std::function<void()> changing,
                 std::function<void()> leaving)
    : registry_(registry), threads_(threads), changing_(std::move(changing)), leaving_(std::move(leaving)) {}

void PastRun::forget() {
  if (simulation_) leaving_();
  shown_.reset();
  isSetUp_ = false;
  simulation_.reset();
  device_.reset();
}

void PastRun::begin(std::unique_ptr<Scene> scene, std::string device) {
  forget();
  scene_ = std::move(scene);
  deviceName_ = std::move(device);
}

void PastRun::build(const RunState& state) {
  if (!simulation_) {
    device_ = openDevice(deviceName_, threads_);
    simulation_ = std::make_unique<Simulation>(std::move(scene_), *device_, silent_, registry_);
  }
  if (!isSetUp_) simulation_->replay();
  isSetUp_ = true;
  const StateReader from(*state);
  std::int64_t frame = 0;
  from.in("clock").get("frame", frame);
  simulation_->scene().graph.restore(from.in("nodes").on(*device_));
  simulation_->showAt(frame, simulation_->clock().frameTime(frame));
}

Simulation& PastRun::at(const RunState& state) {
  WEIR_CHECK((scene_ || simulation_));
  if (shown_ == state) return *simulation_;
  if (simulation_) changing_();
  shown_.reset();
  try {
    build(state);
  } catch (const std::bad_alloc&) {
    throw usageError("the frame cannot be built beside the run: out of memory");
  } catch (const std::exception& e) {
    throw usageError(std::string("the frame cannot be built beside the run: ") + e.what());
  }
  shown_ = state;
  return *simulation_;
}

}  // namespace weir::studio
