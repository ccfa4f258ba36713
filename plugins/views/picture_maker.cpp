#include "plugins/views/picture_maker.h"

namespace weir::rendering {

std::unique_ptr<Device> siblingOf(const Device& device) {
  const auto* cpu = dynamic_cast<const CpuDevice*>(&device);
  return openDevice(device.name(), cpu != nullptr ? cpu->threads() : 0);
}

}  // namespace weir::rendering
