#include "framework/particles/periodic_images.h"

#include <algorithm>
#include <utility>

#include "framework/compute/dispatch.h"
#include "framework/particles/pack_layout.h"

namespace weir {

namespace {

/// Positions are rounded where they are shifted, so images are shown from a bit farther away.
constexpr float kRounding = 1e-3f;

}  // namespace

PeriodicImages::PeriodicImages(ParticleSet& particles, const Period& period, float reach)
    : particles_(particles),
      period_(period),
      reach_((1 + kRounding) * reach),
      firsts_(particles.device()),
      owners_(particles.device()),
      shifts_(particles.device()),
      buffer_(particles.device()) {}

double PeriodicImages::shareOf(const Period& period, float reach) {
  double boxes = 1;
  for (int axis = 0; axis < 3; ++axis)
    if (period.along(axis))
      boxes *= 1 + 2 * double(1 + kRounding) * double(reach) / double(period.size[axis]);
  return boxes - 1;
}

void PeriodicImages::wrap() {
  dispatch(particles_.device(), [&](auto& device) { wrapOn(device); });
}

void PeriodicImages::show() {
  owners_.resizeDiscarding(0);
  if (particles_.refreshCount() == 0) return;
  dispatch(particles_.device(), [&](auto& device) { findOn(device); });
  const PackLayout layout(particles_, {"position", "id"});
  particles_.pack(layout, std::as_const(owners_).view(), buffer_);
  particles_.appendHalo(layout, std::as_const(buffer_).view());
  shiftPositions();
}

void PeriodicImages::refresh(std::initializer_list<std::string_view> attributes) {
  if (owners_.empty()) return;
  const PackLayout layout(particles_, attributes);
  particles_.pack(layout, std::as_const(owners_).view(), buffer_);
  particles_.refreshHalo(layout, std::as_const(buffer_).view(), {0, owners_.size()});
  if (std::find(attributes.begin(), attributes.end(), "position") != attributes.end()) shiftPositions();
}

void PeriodicImages::shiftPositions() {
  if (owners_.empty()) return;
  dispatch(particles_.device(), [&](auto& device) { shiftOn(device); });
}

template <class T>
void PeriodicImages::refreshAll(ArrayView<T> values) {
  if (owners_.empty()) return;
  const bool imagesAreThere =
      particles_.haloCount() == owners_.size() && values.size >= particles_.bound() + owners_.size();
  WEIR_CHECK(imagesAreThere);
  dispatch(particles_.device(), [&](auto& device) { refreshOn(device, values); });
}

void PeriodicImages::refresh(ArrayView<float> values) {
  refreshAll(values);
}

void PeriodicImages::refresh(ArrayView<Vec3f> values) {
  refreshAll(values);
}

void PeriodicImages::refresh(ArrayView<Vec4f> values) {
  refreshAll(values);
}

}  // namespace weir
