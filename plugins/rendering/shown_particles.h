// The particles that clip planes leave.
#pragma once

#include <vector>

#include "plugins/rendering/render_settings.h"
#include "plugins/rendering/view.h"

namespace weir::rendering {

/// Whether no plane hides a place.
bool isShown(const GroupList<ClipSettings>& clips, const Vec3f& place);

/// Holds copies of the particles of a view that are shown.
class ShownParticles {
 public:
  /// Lets the view have those alone; they are valid until the next call.
  void choose(const GroupList<ClipSettings>& clips, ParticleView& view);

 private:
  std::vector<Vec3f> positions_;
  std::vector<float> values_, foam_;
};

}  // namespace weir::rendering
