#include "nodes/particle_fluid/modules/anderson.h"

#include "framework/graph/memory_estimate.h"

namespace weir {

void AndersonMixing::reserve(Device& device, std::int64_t particles, bool shares) {
  if (gram_.data() == nullptr) {
    starts_ = Array<Vec3f>(device);
    results_ = Array<Vec3f>(device);
    shares_ = Array<float>(device);
    gram_ = Array<AndersonGram>(device, 1);
    weights_ = Array<AndersonWeights>(device, 1);
  }
  const std::int64_t size = AndersonHistory::kEntries * particles;
  starts_.resizeDiscarding(size);
  results_.resizeDiscarding(size);
  shares_.resizeDiscarding(shares ? size : 0);
}

double AndersonMixing::memoryFor(double particles, bool shares) const {
  const double size = AndersonHistory::kEntries * particles;
  return bytesOfArrays(size, starts_, results_) + (shares ? bytesOfArrays(size, shares_) : 0);
}

void AndersonMixing::release() {
  *this = {};
}

AndersonHistory AndersonMixing::view() {
  return {starts_.view(), results_.view(), shares_.view(), starts_.size() / AndersonHistory::kEntries};
}

}  // namespace weir
