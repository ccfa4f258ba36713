#include "nodes/particle_fluid/body_coupling.h"

namespace weir {

namespace {

struct PlaceBody {
  ArrayView<SolidView> solids;
  Vec3d gravity;
  double dt;

  WEIR_HD void operator()(std::int64_t k) const {
    SolidView& solid = solids[k];
    if (solid.body == nullptr) return;
    FreeBody& body = *solid.body;
    const bool moves = dt > 0;
    body.placed = moves ? 1 : 0;
    body.predicted = moves ? flown(body.mass, body.state, gravity, dt, body.applied) : body.state;
    body.displacement = body.searched = body.change = {};
    // While it only stands there, fluid that meets it must not be carried along.
    body.motion = moves ? twistOf(body.mass, body.predicted) : Twist{};
    body.received = {};
    solid.begin = poseOf(body.mass, body.state);
    solid.end = solid.predicted = poseOf(body.mass, body.predicted);
    solid.pivot = floatOf(body.predicted.center);
  }
};

}  // namespace

template <class Backend>
void placeBodiesOn(Backend& device, WallField& walls, const Vec3f& gravity, double dt) {
  if (walls.hasBodies())
    parallelFor(device, "place bodies", walls.views.size(),
                PlaceBody{walls.views.view(), doubleOf(gravity), dt});
  walls.sortSolids(device);
}

template void placeBodiesOn(ThisBackend&, WallField&, const Vec3f&, double);

}  // namespace weir
