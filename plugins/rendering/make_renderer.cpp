#include "plugins/rendering/make_renderer.h"

#include <dlfcn.h>

#include "plugins/rendering/gl/context.h"

namespace weir::rendering {

std::filesystem::path fontFolder() {
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&fontFolder), &self) == 0) return {};
  return std::filesystem::absolute(self.dli_fname).parent_path() / "../../../share/weir/fonts";
}

// A device draws what pictures it can alone: on a GPU because OpenGL may have few of its processors, on the
// CPU because kernels do it in a third of the time. Where OpenGL is a GPU's, though, the CPU leaves all to
// it.
std::unique_ptr<gl::Renderer> makeRenderer(const Device& device) {
  std::unique_ptr<gl::Context> context = gl::makeContext();
  const bool draws = device.kind() == DeviceKind::kCuda || context->isSoftware();
  return std::make_unique<gl::Renderer>(std::move(context), siblingOf(device),
                                        draws ? gl::ComputeShare::kWhatCanBe : gl::ComputeShare::kNothing);
}

}  // namespace weir::rendering
