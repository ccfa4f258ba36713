#include "wave_paddle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace wave_paddle {

void WavePaddle::validate() const {
  if (!(length(direction.get()) > 0))
    throw sceneError("the direction is 0", "a direction").inParameter(direction.name());
}

void WavePaddle::configure(const SetupContext&) {
  fluid.request({static_cast<int>(solids.size())});
}

double WavePaddle::wantedAt(double time) const {
  const double fade = ramp > 0 ? std::min(time / ramp, 1.0) : 1.0;
  return fade * 0.5 * stroke * std::sin(2 * std::numbers::pi * time / period);
}

void WavePaddle::chooseVelocity(double time, double dt) {
  const double max = acceleration * dt;
  velocity_ += std::clamp((wantedAt(time + dt) - position_) / dt - velocity_, -max, max);
}

void WavePaddle::reset(const SetupContext& context) {
  time_ = position_ = velocity_ = force_ = lastFrame_ = 0;
  chooseVelocity(0, context.dt);
  parts_->clear();
  float detail = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < fluid.size(); ++i) detail = std::min(detail, fluid[i].material.spacing);
  for (std::size_t k = 0; k < solids.size(); ++k)
    parts_->push_back(std::make_unique<Solid>(context.device, solids[k], SolidSurface{}, *this, detail));
  for (std::size_t i = 0; i < fluid.size(); ++i)
    if (const std::int64_t removed = couplingOf(fluid, i).accept(parts_.get()); removed > 0)
      context.log.warn("node '" + name() + "': " + std::to_string(removed) +
                       " particles start inside the paddle and are left out");
}

Pose WavePaddle::poseAt(double time) const {
  const auto moved = static_cast<float>(position_ + velocity_ * (time - time_));
  return {{}, moved * (direction.get() / length(direction.get()))};
}

double WavePaddle::longestStep(const StepContext&, double cfl) {
  double spacing = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < fluid.size(); ++i)
    spacing = std::min(spacing, double(fluid[i].material.spacing));
  return velocity_ != 0 ? cfl * spacing / std::abs(*velocity_) : std::numeric_limits<double>::infinity();
}

void WavePaddle::step(const StepContext& context) {
  position_ += velocity_ * context.dt;
  time_ = context.time + context.dt;
  chooseVelocity(time_, context.dt);
}

void WavePaddle::frame(const StepContext& context) {
  const double elapsed = context.time - lastFrame_;
  if (!(elapsed > 0)) return;
  lastFrame_ = context.time;
  Vec3d sum{};
  for (const auto& part : *parts_) {
    sum += part->impulse().toHost().front().linear;
    part->impulse().fillZero();
  }
  const Vec3f along = direction.get() / length(direction.get());
  force_ = (sum.x * along.x + sum.y * along.y + sum.z * along.z) / elapsed;
}

void WavePaddle::report(NodeReport& report) {
  report.statistics["position"] = position_.get();
  report.statistics["velocity"] = velocity_.get();
  report.statistics["force"] = force_.get();
}

}  // namespace wave_paddle
