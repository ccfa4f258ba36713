#include "plugins/rendering/shown_particles.h"

namespace weir::rendering {

bool isShown(const GroupList<ClipSettings>& clips, const Vec3f& place) {
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (!clips[i].shows(place)) return false;
  return true;
}

void ShownParticles::choose(const GroupList<ClipSettings>& clips, ParticleView& view) {
  positions_.clear();
  values_.clear();
  foam_.clear();
  for (std::size_t i = 0; i < view.positions.size(); ++i) {
    if (!isShown(clips, view.positions[i])) continue;
    positions_.push_back(view.positions[i]);
    if (!view.values.empty()) values_.push_back(view.values[i]);
    if (!view.foam.empty()) foam_.push_back(view.foam[i]);
  }
  view.positions = positions_;
  view.values = values_;
  view.foam = foam_;
}

}  // namespace weir::rendering
