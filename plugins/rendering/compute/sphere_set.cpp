#include "plugins/rendering/compute/sphere_set.h"

#include <algorithm>
#include <utility>

#include "framework/base/check.h"
#include "framework/compute/dispatch.h"
#include "plugins/rendering/gl/particle_colors.h"
#include "plugins/views/frame_kernels.h"

namespace weir::rendering {

namespace {

/// In the order in which they are packed.
enum class Kind { kCasting, kWhite, kLiquid };

Kind kindOf(const ParticleView& view) {
  if (view.water) return Kind::kLiquid;
  return view.white ? Kind::kWhite : Kind::kCasting;
}

}  // namespace

Aabb SphereSet::load(std::span<const ParticleView> views) {
  std::int64_t total = 0;
  for (const ParticleView& view : views) total += static_cast<std::int64_t>(view.positions.size());
  spheres_.resizeDiscarding(total);
  boxes_.resizeDiscarding(static_cast<std::int64_t>(views.size()));
  while (inputs_.size() < views.size()) inputs_.push_back(std::make_unique<Input>(device_));

  parts_.assign(1, {});
  opaqueEnds_.clear();
  std::int64_t end = 0;
  for (const Kind kind : {Kind::kCasting, Kind::kWhite, Kind::kLiquid}) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      const ParticleView& view = views[i];
      if (kindOf(view) != kind) continue;
      const ArrayView<const SplatSphere> spheres = pack(view, end, *inputs_[i], boxes_.data() + i);
      end += spheres.size;
      if (view.water)
        parts_.push_back({view.water, view.radius, view.inset(), view.chord(), spheres, spheres});
      else
        opaqueEnds_.push_back(end);
    }
    if (kind == Kind::kCasting) parts_.front().casting = {spheres_.data(), end};
    if (kind == Kind::kWhite) parts_.front().spheres = {spheres_.data(), end};
  }

  Aabb all;
  const std::vector<Aabb> boxes = boxes_.toHost();
  for (std::size_t i = 0; i < views.size(); ++i) all.extend(widened(boxes[i], views[i].radius));
  return all;
}

ArrayView<const SplatSphere> SphereSet::pack(const ParticleView& view, std::int64_t first, Input& input,
                                             Aabb* box) {
  const std::span<const float> numbers = view.water ? view.foam : view.values;
  if (!numbers.empty()) WEIR_CHECK(numbers.size() == view.positions.size());
  input.texels.assign(view.water ? std::vector<std::uint32_t>() : gl::particleColors(view));
  const ArrayView<const Vec3f> positions = input.positions.of(view.positions, view.onDevice);
  const ArrayView<const float> values = input.values.of(numbers, view.onDevice);
  const ArrayView<SplatSphere> spheres{spheres_.data() + first, positions.size};
  const SphereColors colors{.texels = std::as_const(input.texels).view(),
                            .entries = {view.lowest, view.highest},
                            .radius = view.radius};
  dispatch(device_, [&](auto& device) {
    packSpheres(device, positions, values, colors, spheres);
    boxOf(device, positions, box);
  });
  return spheres;
}

bool SphereSet::has(std::optional<std::size_t> liquid) const {
  return std::any_of(parts_.begin(), parts_.end(),
                     [&](const Part& part) { return part.liquid == liquid && part.spheres.size > 0; });
}

}  // namespace weir::rendering
