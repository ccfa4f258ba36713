#include "nodes/particle_fluid/wall_field.h"

namespace weir {

void WallField::place(double time, double dt) {
  placed_.clear();
  for (Solid* solid : solids) placed_.push_back(solid->view(time, dt));
  views.assign(placed_);
}

void WallField::fit(std::int64_t particles) {
  stride = particles;
  each.resizeDiscarding(particles * static_cast<std::int64_t>(solids.size()));
  if (solids.size() > 1) total.resizeDiscarding(particles);
  d.resizeDiscarding(particles);
  share.resizeDiscarding(particles);
  sides.resizeDiscarding(each.size());
  legal.resizeDiscarding(particles);
  kick.resizeDiscarding(particles);
}

}  // namespace weir
