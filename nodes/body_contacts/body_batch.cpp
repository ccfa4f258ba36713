#include "nodes/body_contacts/body_batch.h"

#include "framework/compute/dispatch.h"

namespace weir {

BodyBatch::BodyBatch(Device& device, const std::vector<Member>& members)
    : members_(device, members),
      motions_(device, static_cast<std::int64_t>(members.size())),
      placed_(device) {}

std::vector<BodyDynamics::Motion> BodyBatch::moveOn(const Vec3f& gravity, double dt) {
  dispatch(members_.device(), [&](auto& device) { moveOnOn(device, gravity, dt); });
  return motions_.toHost();
}

std::int64_t BodyBatch::place(const std::vector<BodyDynamics::Motion>& motions) {
  std::vector<Placed> placed;
  for (std::size_t k = 0; k < motions.size(); ++k)
    if (motions[k].held) placed.push_back({static_cast<std::int64_t>(k), motions[k].after});
  placed_.assign(placed);
  dispatch(members_.device(), [&](auto& device) { placeOn(device); });
  return placed_.size();
}

}  // namespace weir
