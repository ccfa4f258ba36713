#include "plugins/rendering/compute/sphere_set.h"

#include "framework/base/check.h"
#include "framework/compute/dispatch.h"
#include "plugins/rendering/gl/particle_colors.h"
#include "plugins/rendering/shading/formulas.h"

namespace weir::rendering {

namespace {

constexpr auto kParticleMaterial = static_cast<std::uint32_t>(255 * shading::kParticle + 0.5f);

std::vector<std::uint32_t> packedTexels(const ParticleView& particles) {
  const std::vector<std::uint8_t> bytes = gl::particleColors(particles);
  std::vector<std::uint32_t> texels;
  for (std::size_t i = 0; i < bytes.size(); i += 4)
    texels.push_back(bytes[i] | std::uint32_t{bytes[i + 1]} << 8 | std::uint32_t{bytes[i + 2]} << 16 |
                     kParticleMaterial << 24);
  return texels;
}

}  // namespace

Aabb SphereSet::load(std::span<const ParticleView> views) {
  std::int64_t total = 0;
  for (const ParticleView& view : views) total += static_cast<std::int64_t>(view.positions.size());
  spheres_.resizeDiscarding(total);
  boxes_.resizeDiscarding(static_cast<std::int64_t>(views.size()));
  while (inputs_.size() < views.size()) inputs_.push_back(std::make_unique<Input>(device_));

  std::int64_t first = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const ParticleView& view = views[i];
    if (!view.values.empty()) WEIR_CHECK(view.values.size() == view.positions.size());
    Input& input = *inputs_[i];
    input.texels.assign(packedTexels(view));
    const ArrayView<const Vec3f> positions = input.positions.of(view.positions, view.onDevice);
    const ArrayView<const float> values = input.values.of(view.values, view.onDevice);
    const ArrayView<SplatSphere> spheres{spheres_.data() + first, positions.size};
    const SphereColors colors{.texels = static_cast<const Array<std::uint32_t>&>(input.texels).view(),
                              .entries = {view.lowest, view.highest},
                              .radius = view.radius};
    dispatch(device_, [&](auto& device) {
      packSpheres(device, positions, values, colors, spheres);
      boxOf(device, positions, boxes_.data() + i);
    });
    first += positions.size;
  }

  Aabb all;
  const std::vector<Aabb> boxes = boxes_.toHost();
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (boxes[i].empty()) continue;
    const Vec3f around{views[i].radius, views[i].radius, views[i].radius};
    all.extend(Aabb{boxes[i].lo - around, boxes[i].hi + around});
  }
  return all;
}

}  // namespace weir::rendering
