#include "python/src/pictures.h"

#include <utility>

#include "framework/base/error.h"
#include "framework/graph/registry.h"

namespace weir::python {

Pictures::Pictures(Simulation& simulation) {
  auto services = simulation.registry().createServices<LivePictures>();
  if (services.empty())
    throw usageError("no plugin that draws pictures is loaded",
                     "the plugin 'rendering', which comes with Weir");
  part_ = {"pictures", services.front().source};
  pictures_ = std::move(services.front().implementation);
  part_.call("open", [&] { renderer_ = pictures_->open(simulation); });
}

LivePixels Pictures::draw(Simulation& simulation, const LivePictureOptions& options) {
  LivePixels pixels;
  part_.call("capture", [&] { snapshot_ = renderer_->capture(simulation, std::move(snapshot_)); });
  part_.call("pixels", [&] { pixels = renderer_->pixels(*snapshot_, options); });
  return pixels;
}

}  // namespace weir::python
