#include "plugins/rendering/shading/patterns.h"

#include <cmath>
#include <numbers>

namespace weir::rendering {

namespace {

constexpr float kCircle = 2 * std::numbers::pi_v<float>;

Vec2f onCircle(float angle) {
  return {std::cos(angle), std::sin(angle)};
}

Vec2f scaled(float radius, const Vec2f& v) {
  return {radius * v.x, radius * v.y};
}

}  // namespace

ShadowPattern shadowPattern() {
  constexpr float kGoldenAngle = 2.3999632f, kQuarter = 0.5f * std::numbers::pi_v<float>;
  ShadowPattern pattern;
  for (int i = 0; i < 4; ++i) {
    const auto n = static_cast<float>(i);
    pattern.taps[i] = scaled(std::sqrt((n + 0.5f) / 4), onCircle(n * kGoldenAngle));
    pattern.turns[i] = onCircle(kQuarter * n / 4);
  }
  return pattern;
}

OcclusionPattern occlusionPattern() {
  constexpr int kTaps = OcclusionPattern::kTaps, kTurns = OcclusionPattern::kTurns;
  constexpr float kAround = 7;
  OcclusionPattern pattern;
  for (int i = 0; i < kTaps; ++i) {
    const float part = (static_cast<float>(i) + 0.5f) / kTaps;
    pattern.taps[i] = scaled(part, onCircle(kCircle * kAround * part));
  }
  for (int i = 0; i < kTurns; ++i) pattern.turns[i] = onCircle(static_cast<float>(i) * (kCircle / kTurns));
  return pattern;
}

}  // namespace weir::rendering
