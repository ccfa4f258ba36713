#include "framework/graph/plugin_header.h"
#include "framework/run/info_source.h"
#include "plugins/cycles/blender_output.h"
#include "plugins/pictures/live_view.h"
#include "plugins/pictures/picture_output.h"
#include "plugins/rendering/gl/context.h"
#include "plugins/usd/usd_output.h"
#include "plugins/views/render_settings.h"

namespace weir::rendering {

namespace {

class RenderingInfo final : public InfoSource {
 public:
  std::vector<InfoEntry> info() const override {
    return {{"OSMesa", tryOut(gl::Provider::kOsMesa)}, {"EGL", tryOut(gl::Provider::kEgl)}};
  }

 private:
  static std::string tryOut(gl::Provider provider) {
    try {
      return "works: " + gl::makeContext(provider)->description();
    } catch (const Error& e) {
      return e.message();
    }
  }
};

}  // namespace

}  // namespace weir::rendering

WEIR_PLUGIN("rendering", "Videos and pictures of a run, drawn without a screen.", registry) {
  using namespace weir::rendering;
  registry.addSection<RenderSettings>("render", "What the pictures show, and from where.");
  registry.addService<weir::OutputKind>("pictures", [] { return std::make_unique<PictureOutput>(); });
  registry.addService<weir::OutputKind>("frames for Blender",
                                        [] { return std::make_unique<BlenderOutput>(); });
  registry.addService<weir::OutputKind>("USD", [] { return std::make_unique<UsdOutput>(); });
  registry.addService<weir::LivePictures>("pictures", [] { return std::make_unique<LiveView>(); });
  registry.addService<weir::InfoSource>("rendering", [] { return std::make_unique<RenderingInfo>(); });
}
