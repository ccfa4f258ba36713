#include "framework/solids/solid_pairs.h"

#include "framework/graph/memory_estimate.h"

namespace weir {

SolidPairs::SolidPairs(Device& device)
    : count_(device),
      first_(device),
      solid_(device),
      marks_(device),
      near_(device),
      nearCounter_(device, 1),
      lost_(device, 1),
      bySolid_(device) {
  lost_.fillZero();
}

void SolidPairs::makeRoom(std::int64_t particles, std::int64_t solids) {
  Device& device = first_.device();
  // On the CPU, what has been counted is there.
  const bool exact = device.kind() == DeviceKind::kCpu;
  if (exact || waits_) {
    if (!number_) number_.emplace(device);
    number_->request(first_.data() + particles);
    const std::int64_t number = number_->wait();
    wanted_ = exact ? number : 2 * number;
    waits_ = false;
  }
  const std::int64_t usual = exact ? 0 : kUsual * particles;
  const std::int64_t room = std::min(std::max(usual, wanted_), solids * particles);
  if (room > solid_.size())
    solid_.resizeDiscarding(std::min(grownSize(solid_.size(), room), solids * particles));
}

double SolidPairs::memoryFor(double particles, int solids, std::size_t bytesOfPair) const {
  const double pairs = particles * std::min<std::int64_t>(solids, kUsual);
  return bytesOfArrays(particles + 1, count_, first_) + bytesOfArrays(particles, near_, marks_) +
         bytesOfArrays(pairs, solid_) + bytesOfArray(pairs, bytesOfPair) + KeyLists::memoryFor(pairs, solids);
}

}  // namespace weir
