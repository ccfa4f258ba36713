#include "plugins/rendering/make_renderer.h"

#include <dlfcn.h>

#include "plugins/rendering/gl/context.h"

namespace weir::rendering {

namespace {

/// Another device on the same machine, for another thread.
std::unique_ptr<Device> sibling(const Device& device) {
  const auto* cpu = dynamic_cast<const CpuDevice*>(&device);
  return openDevice(device.name(), cpu != nullptr ? cpu->threads() : 0);
}

}  // namespace

std::filesystem::path fontFolder() {
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&fontFolder), &self) == 0) return {};
  return std::filesystem::absolute(self.dli_fname).parent_path() / "../../../share/weir/fonts";
}

std::unique_ptr<gl::Renderer> makeRenderer(const Device& device) {
  std::unique_ptr<gl::Context> context = gl::makeContext();
  if (device.kind() == DeviceKind::kCuda)
    return std::make_unique<gl::Renderer>(std::move(context), sibling(device), gl::ComputeShare::kWhatCanBe);
  std::unique_ptr<Device> helper = context->isSoftware() ? sibling(device) : nullptr;
  return std::make_unique<gl::Renderer>(std::move(context), std::move(helper));
}

}  // namespace weir::rendering
