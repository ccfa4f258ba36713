#include "plugins/views/camera_path.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace weir::rendering {

namespace {

/// What changes between keyframes, as one vector.
struct Moment {
  Vec3f eye, target;
  float fov = 0;

  friend Moment operator+(const Moment& a, const Moment& b) {
    return {a.eye + b.eye, a.target + b.target, a.fov + b.fov};
  }
  friend Moment operator-(const Moment& a, const Moment& b) { return a + -1.0f * b; }
  friend Moment operator*(float s, const Moment& m) { return {s * m.eye, s * m.target, s * m.fov}; }
};

Moment momentOf(const CameraKey& key, float fov) {
  return {key.eye, key.target, key.fov.get().value_or(fov)};
}

/// The keyframes of a camera.
class Keys {
 public:
  Keys(const CameraSettings& settings, float fov) : keys_(settings.keyframes), fov_(fov) {}

  std::size_t count() const { return keys_.size(); }
  double time(std::size_t i) const { return keys_[i].time; }
  Moment moment(std::size_t i) const { return momentOf(keys_[i], fov_); }

  /// Change in a second at a keyframe.
  Moment speed(std::size_t i) const {
    if (i == 0 || i + 1 == count()) return {};
    const auto before = static_cast<float>(time(i) - time(i - 1));
    const auto after = static_cast<float>(time(i + 1) - time(i));
    const Moment slopeBefore = (1 / before) * (moment(i) - moment(i - 1));
    const Moment slopeAfter = (1 / after) * (moment(i + 1) - moment(i));
    return (1 / (before + after)) * (after * slopeBefore + before * slopeAfter);
  }

 private:
  const GroupList<CameraKey>& keys_;
  float fov_;
};

/// C. Hermite's cubic at t in [0, 1] between a and b, with speeds for all of the way.
Moment cubic(const Moment& a, const Moment& speedA, const Moment& b, const Moment& speedB, float t) {
  const float t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * speedA + (3 * t2 - 2 * t3) * b + (t3 - t2) * speedB;
}

Moment momentAt(const Keys& keys, double time, bool smooth) {
  std::size_t next = 0;
  while (next < keys.count() && keys.time(next) <= time) ++next;
  if (next == 0) return keys.moment(0);
  if (next == keys.count()) return keys.moment(next - 1);
  const std::size_t last = next - 1;
  const auto span = static_cast<float>(keys.time(next) - keys.time(last));
  const float t = static_cast<float>(time - keys.time(last)) / span;
  const Moment a = keys.moment(last), b = keys.moment(next);
  if (!smooth) return a + t * (b - a);
  return cubic(a, span * keys.speed(last), b, span * keys.speed(next), t);
}

/// A vector turned about a unit axis (O. Rodrigues 1840).
Vec3f turned(const Vec3f& v, const Vec3f& axis, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return c * v + s * cross(axis, v) + ((1 - c) * dot(axis, v)) * axis;
}

}  // namespace

CameraPose cameraAt(const CameraSettings& settings, const CameraPose& resting, double time,
                    const std::optional<Vec3f>& followed) {
  CameraPose camera = resting;
  if (!settings.keyframes.empty()) {
    const Moment moment = momentAt(Keys(settings, resting.fovDegrees), time, settings.smooth);
    camera.eye = moment.eye;
    camera.target = moment.target;
    camera.fovDegrees = moment.fov;
  }
  if (const auto& period = settings.orbitPeriod.get()) {
    const double turns = time / *period;
    const auto angle = static_cast<float>(2 * std::numbers::pi * (turns - std::floor(turns)));
    camera.eye = camera.target + turned(camera.eye - camera.target, normalized(camera.up), angle);
  }
  if (followed) {
    camera.eye += *followed - camera.target;
    camera.target = *followed;
  }
  return camera;
}

}  // namespace weir::rendering
