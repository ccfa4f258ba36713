#include "plugins/rendering/gl/environment.h"

namespace weir::rendering::gl {

void setEnvironmentUniforms(const Program& program, const Frame& frame) {
  const View& view = frame.view;
  program.set("uZenith", 0.55f * linear(view.backgroundTop));
  program.set("uHorizon", 1.1f * linear(view.backgroundBottom));
  program.set("uBelow", 0.5f * linear(view.ground.visible ? view.ground.color : view.backgroundBottom));
}

}  // namespace weir::rendering::gl
