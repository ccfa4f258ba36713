#include "nodes/body_contacts/body_batch.h"

#include <utility>

#include "framework/compute/parallel.h"
#include "nodes/rigid_body/move_on.h"

namespace weir {

namespace {

struct MoveOn {
  ArrayView<const BodyBatch::Member> members;
  ArrayView<BodyDynamics::Motion> motions;
  Vec3d gravity;
  double dt;

  WEIR_HD void operator()(std::int64_t k) const {
    FreeBody& body = *members[k].body;
    if (members[k].moves) moveOn(body, gravity, dt);
    motions[k].before = body.before;
    motions[k].after = body.state;
    motions[k].held = false;
  }
};

struct PlaceBody {
  ArrayView<const BodyBatch::Member> members;
  ArrayView<const BodyBatch::Placed> placed;

  WEIR_HD void operator()(std::int64_t n) const {
    FreeBody& body = *members[placed[n].k].body;
    body.state = placed[n].state;
    body.motion = twistOf(body.mass, body.state);
  }
};

}  // namespace

template <class Backend>
void BodyBatch::moveOnOn(Backend& device, const Vec3f& gravity, double dt) {
  parallelFor(device, "move on", members_.size(),
              MoveOn{std::as_const(members_).view(), motions_.view(), doubleOf(gravity), dt});
}

template <class Backend>
void BodyBatch::placeOn(Backend& device) {
  parallelFor(device, "place bodies", placed_.size(),
              PlaceBody{std::as_const(members_).view(), std::as_const(placed_).view()});
}

template void BodyBatch::moveOnOn(ThisBackend&, const Vec3f&, double);
template void BodyBatch::placeOn(ThisBackend&);

}  // namespace weir
