// The particles of a picture as spheres on a compute device.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "framework/compute/array.h"
#include "plugins/rendering/compute/device_input.h"
#include "plugins/rendering/compute/sphere_kernels.h"
#include "plugins/views/view.h"

namespace weir::rendering {

class SphereSet {
 public:
  explicit SphereSet(Device& device) : device_(device), spheres_(device), boxes_(device) {}

  /// The particles of one view, or of all that are no liquid.
  struct Part {
    std::optional<std::size_t> liquid;       ///< ParticleView::water
    float radius = 0, inset = 0, chord = 0;  ///< m, of a liquid (ParticleView)
    ArrayView<const SplatSphere> spheres;
    /// Of these, what casts shadows: all but white water, as light gets through that.
    ArrayView<const SplatSphere> casting;
  };

  /// Takes the particles of a picture and returns the box around their spheres. Waits for the device.
  Aabb load(std::span<const ParticleView> views);
  /// What is no liquid, one view behind the other.
  const Part& opaque() const { return parts_.front(); }
  /// Where the spheres of each view end among these: of what casts shadows, then of white water.
  std::span<const std::int64_t> opaqueEnds() const { return opaqueEnds_; }
  /// The opaque ones first.
  std::span<const Part> parts() const { return parts_; }
  /// Whether there are particles of that liquid, or that are none.
  bool has(std::optional<std::size_t> liquid) const;

 private:
  /// What one view needs while its kernels run.
  struct Input {
    explicit Input(Device& device) : positions(device), values(device), texels(device) {}
    DeviceInput<Vec3f> positions;
    DeviceInput<float> values;
    Array<std::uint32_t> texels;
  };

  /// Packs the particles of a view from a place on.
  ArrayView<const SplatSphere> pack(const ParticleView& view, std::int64_t first, Input& input, Aabb* box);

  Device& device_;
  std::vector<std::unique_ptr<Input>> inputs_;
  Array<SplatSphere> spheres_;
  Array<Aabb> boxes_;  // of the centres of each view
  std::vector<Part> parts_{1};
  std::vector<std::int64_t> opaqueEnds_;
};

}  // namespace weir::rendering
