#include "nodes/white_water/walls_of_fluid.h"

#include "framework/compute/parallel.h"

namespace weir {

namespace {

/// Solid k, if forces move it, goes from where it was to where the fluid, or its node after that, has put it.
struct PlaceBody {
  ArrayView<SolidView> solids;
  ArrayView<Pose> poses;
  bool known;

  WEIR_HD void operator()(std::int64_t k) const {
    SolidView& solid = solids[k];
    if (solid.body == nullptr) return;
    const FreeBody& body = *solid.body;
    const BodyState now = body.placed != 0 ? body.predicted.moved(body.displacement) : body.state;
    solid.begin = known ? poses[k] : poseOf(body.mass, body.state);
    solid.end = solid.predicted = poseOf(body.mass, now);
    solid.pivot = floatOf(now.center);
    poses[k] = solid.end;
  }
};

}  // namespace

template <class Backend>
void WallsOfFluid::placeBodiesOn(Backend& device, Array<Pose>& poses, bool known) {
  if (!known) poses.fillZero();
  parallelFor(device, "place bodies", solids_.size(), PlaceBody{solids_.view(), poses.view(), known});
}

template void WallsOfFluid::placeBodiesOn(ThisBackend&, Array<Pose>&, bool);

}  // namespace weir
