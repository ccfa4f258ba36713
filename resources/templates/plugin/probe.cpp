#include "probe.h"

#include <algorithm>
#include <vector>

namespace my_plugin {

void Probe::validate() const {
  if (Aabb{min, max}.empty()) throw sceneError("min is above max", "a box that is not empty");
}

void Probe::reset(const SetupContext&) {
  inside_ = maxInside_ = 0;
}

void Probe::frame(const StepContext&) {
  const Aabb box{min, max};
  const std::int64_t count = fluid->set().refreshCount();
  const std::vector<Vec3f> positions = fluid->set().positions().toHost(count);
  inside_ =
      std::count_if(positions.begin(), positions.end(), [&](const Vec3f& p) { return box.contains(p); });
  maxInside_ = std::max(*maxInside_, *inside_);
}

void Probe::report(NodeReport& report) {
  report.statistics["particles_inside"] = inside_.get();
  report.statistics["max_particles_inside"] = maxInside_.get();
}

}  // namespace my_plugin
