#include "nodes/particle_fluid/modules/anderson.h"

#include "nodes/particle_fluid/wall_field.h"

namespace weir {

void AndersonMixing::reserve(FluidStep& fluid) {
  if (gram_.data() == nullptr) {
    starts_ = Array<Vec3f>(fluid.device);
    results_ = Array<Vec3f>(fluid.device);
    shares_ = Array<float>(fluid.device);
    gram_ = Array<AndersonGram>(fluid.device, 1);
    weights_ = Array<AndersonWeights>(fluid.device, 1);
  }
  const std::int64_t size = AndersonHistory::kEntries * fluid.particles.positions().size();
  starts_.resizeDiscarding(size);
  results_.resizeDiscarding(size);
  shares_.resizeDiscarding(fluid.walls.empty() ? 0 : size);
}

void AndersonMixing::release() {
  *this = {};
}

AndersonHistory AndersonMixing::view() {
  return {starts_.view(), results_.view(), shares_.view(), starts_.size() / AndersonHistory::kEntries};
}

}  // namespace weir
