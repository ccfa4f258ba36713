#include "probe.h"

#include <algorithm>
#include <vector>

namespace my_plugin {

void Probe::validate() const {
  if (Aabb{min, max}.empty()) throw sceneError("min is above max", "a box that is not empty");
}

void Probe::reset(const SetupContext&) {
  inside_ = mostInside_ = 0;
}

void Probe::frame(const StepContext&) {
  const Aabb box{min, max};
  const std::int64_t count = fluid->set().refreshCount();
  const std::vector<Vec3f> positions = fluid->set().positions().toHost(count);
  inside_ =
      std::count_if(positions.begin(), positions.end(), [&](const Vec3f& p) { return box.contains(p); });
  mostInside_ = std::max(*mostInside_, *inside_);
}

void Probe::report(NodeReport& report) {
  report.statistics["particles_inside"] = inside_.get();
  report.statistics["most_particles_inside"] = mostInside_.get();
}

}  // namespace my_plugin
