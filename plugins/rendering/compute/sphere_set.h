// The particles of a picture as spheres on a compute device.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "framework/compute/array.h"
#include "plugins/rendering/compute/device_input.h"
#include "plugins/rendering/compute/sphere_kernels.h"
#include "plugins/rendering/view.h"

namespace weir::rendering {

class SphereSet {
 public:
  explicit SphereSet(Device& device) : device_(device), spheres_(device), boxes_(device) {}

  /// Takes the particles of a picture, one view behind the other, and returns the box around their spheres.
  /// Waits for the device.
  Aabb load(std::span<const ParticleView> views);
  ArrayView<const SplatSphere> view() const { return spheres_.view(); }

 private:
  /// What one view needs while its kernels run.
  struct Input {
    explicit Input(Device& device) : positions(device), values(device), texels(device) {}
    DeviceInput<Vec3f> positions;
    DeviceInput<float> values;
    Array<std::uint32_t> texels;
  };

  Device& device_;
  std::vector<std::unique_ptr<Input>> inputs_;
  Array<SplatSphere> spheres_;
  Array<Aabb> boxes_;  // of the centres of each view
};

}  // namespace weir::rendering
