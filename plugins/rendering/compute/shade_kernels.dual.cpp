#include "plugins/rendering/compute/shade_kernels.h"

#include <bit>
#include <cmath>
#include <numbers>

#include "framework/compute/parallel.h"

namespace weir::rendering {

namespace {

using gl::SplatCamera;
using gl::SplatTexels;

WEIR_HD float clamped(float x, float low, float high) {
  return x > low ? (x < high ? x : high) : low;
}
WEIR_HD int clamped(int x, int low, int high) {
  return x > low ? (x < high ? x : high) : low;
}
WEIR_HD float mix(float a, float b, float t) {
  return a + (b - a) * t;
}
WEIR_HD Vec3f mix(const Vec3f& a, const Vec3f& b, float t) {
  return a + (b - a) * t;
}
WEIR_HD Vec3f times(const Vec3f& a, const Vec3f& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
WEIR_HD float smoothstep(float low, float high, float x) {
  const float t = clamped((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}
WEIR_HD std::uint8_t byteOf(float x) {
  return static_cast<std::uint8_t>(clamped(x, 0.0f, 1.0f) * 255.0f + 0.5f);
}

WEIR_HD float distanceAt(const SplatCamera& camera, float depth) {
  return camera.projection.w / (2 * depth - 1 + camera.projection.z);
}

WEIR_HD float tenBits(std::uint32_t packed, int shift) {
  return 2 * static_cast<float>(packed >> shift & 1023u) / 1023.0f - 1;
}
WEIR_HD Vec3f normalOf(std::uint32_t packed) {
  return normalized(Vec3f{tenBits(packed, 0), tenBits(packed, 10), tenBits(packed, 20)});
}
WEIR_HD std::uint32_t toTenBits(float component) {
  return static_cast<std::uint32_t>(clamped(0.5f + 0.5f * component, 0.0f, 1.0f) * 1023.0f + 0.5f);
}
WEIR_HD std::uint32_t packedNormal(const Vec3f& n) {
  return toTenBits(n.x) | toTenBits(n.y) << 10 | toTenBits(n.z) << 20 | 3u << 30;
}

struct AddGround {
  SplatCamera camera;
  ShadedGround ground;
  SplatTexels texels;

  WEIR_HD void operator()(std::int64_t k) const {
    const Vec3f ray = camera.ray(static_cast<int>(k % camera.width), static_cast<int>(k / camera.width));
    const float height = dot(ground.middle, ground.up), falling = dot(ray, ground.up);
    if (!(height < 0) || !(falling < 0)) return;
    const float distance = height / falling;
    if (distance < camera.near || length(ray * distance - ground.middle) > ground.radius) return;
    const float depth = camera.depthAt(distance);
    if (!(depth < texels.depth[k])) return;
    texels.depth[k] = depth;
    texels.albedo[k] = ground.albedo;
    texels.normal[k] = packedNormal(ground.up);
  }
};

/// Eleven places of a spiral of seven turns, a number without a common factor.
constexpr int kTaps = 11;
struct Taps {
  Vec2f at[kTaps];
};

Taps spiral() {
  constexpr float kTurns = 7, kCircle = 2 * std::numbers::pi_v<float>;
  Taps taps;
  for (int i = 0; i < kTaps; ++i) {
    const float part = (static_cast<float>(i) + 0.5f) / kTaps;
    taps.at[i] = {part * std::cos(kCircle * kTurns * part), part * std::sin(kCircle * kTurns * part)};
  }
  return taps;
}

/// Cosine and sine of the sixteen angles by which pixels turn the taps.
struct Turns {
  Vec2f at[16];
};

Turns sixteenTurns() {
  Turns turns;
  for (int i = 0; i < 16; ++i) {
    const float angle = static_cast<float>(i) * (2 * std::numbers::pi_v<float> / 16.0f);
    turns.at[i] = {std::cos(angle), std::sin(angle)};
  }
  return turns;
}

struct EstimateOcclusion {
  SplatCamera camera;
  ShadedOcclusion occlusion;
  int samples, width;
  ArrayView<const float> depth;
  ArrayView<const std::uint32_t> normals;
  Taps taps;
  Turns turns;
  ArrayView<std::uint8_t> open;

  WEIR_HD Vec3f positionAt(int x, int y) const {
    return camera.ray(x, y) * distanceAt(camera, depth[std::int64_t{y} * camera.width + x]);
  }

  WEIR_HD void operator()(std::int64_t k) const {
    const int column = static_cast<int>(k % width), row = static_cast<int>(k / width);
    const int x = column * samples + samples / 2, y = row * samples + samples / 2;
    const std::int64_t place = std::int64_t{y} * camera.width + x;
    if (depth[place] >= 1) {
      open[k] = 255;
      return;
    }
    const Vec3f position = positionAt(x, y), normal = normalOf(normals[place]);
    const float radius = occlusion.radius, square = radius * radius;
    const float wanted = radius * occlusion.radiusInView / -position.z;
    const float reach = wanted < occlusion.largest ? wanted : occlusion.largest;
    const Vec2f unit = turns.at[((column & 3) * 4 + (row & 3) * 7) & 15];
    const Vec2f turn{reach * unit.x, reach * unit.y};
    float sum = 0;
    for (int i = 0; i < kTaps; ++i) {
      const Vec2f tap = taps.at[i];
      const float right = tap.x * turn.x - tap.y * turn.y, up = tap.x * turn.y + tap.y * turn.x;
      const int tapX = clamped(x + static_cast<int>(std::rint(right)), 0, camera.width - 1);
      const int tapY = clamped(y + static_cast<int>(std::rint(up)), 0, camera.height - 1);
      const Vec3f towards = positionAt(tapX, tapY) - position;
      const float way = dot(towards, towards);
      const float within = square > way ? square - way : 0.0f;
      const float over = dot(towards, normal) - 0.02f * radius;
      sum += within * within * within * (over > 0 ? over : 0.0f) / (way + 1e-3f * square);
    }
    const float hemmedIn = sum * 5 / (square * square * radius * static_cast<float>(kTaps));
    open[k] = byteOf(1 - hemmedIn);
  }
};

/// Means over neighbours that are about as far away, along one axis.
struct BlurOcclusion {
  SplatCamera camera;
  float radius;
  int samples, width, height, stepX, stepY;
  ArrayView<const float> depth;
  ArrayView<const std::uint8_t> from;
  ArrayView<std::uint8_t> to;

  WEIR_HD float distanceOf(int column, int row) const {
    const int x = column * samples + samples / 2, y = row * samples + samples / 2;
    return distanceAt(camera, depth[std::int64_t{y} * camera.width + x]);
  }

  WEIR_HD void operator()(std::int64_t k) const {
    const int column = static_cast<int>(k % width), row = static_cast<int>(k / width);
    const float here = distanceOf(column, row);
    float sum = 0, weights = 0;
    for (int i = -2; i <= 2; ++i) {
      const int x = clamped(column + i * stepX, 0, width - 1), y = clamped(row + i * stepY, 0, height - 1);
      const float away = (distanceOf(x, y) - here) / (0.5f * radius);
      const float near = 1 - away * away;
      const float weight = (i == -2 || i == 2 ? 0.5f : 1.0f) * (near > 0 ? near : 0.0f);
      sum += weight * static_cast<float>(from[std::int64_t{y} * width + x]);
      weights += weight;
    }
    to[k] = byteOf(sum / weights * (1 / 255.0f));
  }
};

/// What the lighting needs of tables that never change: four places evenly spread in the unit circle (H.
/// Vogel 1979), and four turns between them.
struct SoftShadow {
  Vec2f taps[4], turns[4];
};

SoftShadow softShadow() {
  constexpr float kGoldenAngle = 2.3999632f, kQuarter = 0.5f * std::numbers::pi_v<float>;
  SoftShadow soft;
  for (int i = 0; i < 4; ++i) {
    const auto n = static_cast<float>(i);
    const float radius = std::sqrt((n + 0.5f) / 4), angle = kQuarter * n / 4;
    soft.taps[i] = {radius * std::cos(n * kGoldenAngle), radius * std::sin(n * kGoldenAngle)};
    soft.turns[i] = {std::cos(angle), std::sin(angle)};
  }
  return soft;
}

struct Shade {
  ShadedPicture in;
  SoftShadow soft;
  ArrayView<std::uint8_t> rgb;

  /// A texel of the shadow map against a depth: 1 if it is lit.
  WEIR_HD float isLit(int x, int y, float depth) const {
    const int last = in.light.shadowResolution - 1;
    const std::int64_t at =
        std::int64_t{clamped(y, 0, last)} * in.light.shadowResolution + clamped(x, 0, last);
    return depth <= std::bit_cast<float>(in.shadow[at]) ? 1.0f : 0.0f;
  }

  /// The comparisons of the four texels around a place, mixed.
  WEIR_HD float litAt(float u, float v, float depth) const {
    const auto size = static_cast<float>(in.light.shadowResolution);
    const float x = clamped(u * size - 0.5f, -1.0f, size), y = clamped(v * size - 0.5f, -1.0f, size);
    const float left = std::floor(x), low = std::floor(y);
    const int column = static_cast<int>(left), row = static_cast<int>(low);
    const float lower = mix(isLit(column, row, depth), isLit(column + 1, row, depth), x - left);
    const float upper = mix(isLit(column, row + 1, depth), isLit(column + 1, row + 1, depth), x - left);
    return mix(lower, upper, y - low);
  }

  WEIR_HD float sunlight(const Vec3f& position, const Vec3f& normal, int x, int y) const {
    const ShadedLight& light = in.light;
    if (light.shadowResolution == 0) return 1;
    const Vec3f p = position + normal * (light.shadowTexel * 2);
    const float u = dot(light.toShadow[0], p) + light.shadowMoved.x;
    const float v = dot(light.toShadow[1], p) + light.shadowMoved.y;
    const float depth = dot(light.toShadow[2], p) + light.shadowMoved.z;
    const Vec2f unit = soft.turns[(x & 1) + 2 * (y & 1)];
    const Vec2f turn{light.softness * unit.x, light.softness * unit.y};
    float open = 0;
    for (int i = 0; i < 4; ++i) {
      const Vec2f tap = soft.taps[i];
      open += 0.25f * litAt(u + tap.x * turn.x - tap.y * turn.y, v + tap.x * turn.y + tap.y * turn.x,
                            depth < 1 ? depth : 1.0f);
    }
    return open;
  }

  WEIR_HD Vec3f skyLight(const Vec3f& normal) const {
    constexpr float kStrength = 0.56f;
    const float above = 0.5f + 0.5f * dot(normal, in.light.up);
    return kStrength * mix(0.62f * in.light.ground, in.light.sky, above * (2 - above));
  }

  /// The occlusion at a sample, mixed of the four pixels around it.
  WEIR_HD float openAt(int x, int y) const {
    const float scale = 1 / static_cast<float>(in.samples);
    const float column = (static_cast<float>(x) + 0.5f) * scale - 0.5f;
    const float row = (static_cast<float>(y) + 0.5f) * scale - 0.5f;
    const float left = std::floor(column), low = std::floor(row);
    const int x0 = clamped(static_cast<int>(left), 0, in.width - 1);
    const int y0 = clamped(static_cast<int>(low), 0, in.height - 1);
    const int x1 = clamped(static_cast<int>(left) + 1, 0, in.width - 1);
    const int y1 = clamped(static_cast<int>(low) + 1, 0, in.height - 1);
    const auto at = [&](int i, int j) {
      return static_cast<float>(in.open[std::int64_t{j} * in.width + i]) * (1 / 255.0f);
    };
    return mix(mix(at(x0, y0), at(x1, y0), column - left), mix(at(x0, y1), at(x1, y1), column - left),
               row - low);
  }

  WEIR_HD Vec3f backgroundAt(int y) const {
    const float height = (static_cast<float>(y) + 0.5f) / static_cast<float>(in.camera.height);
    return mix(in.light.background[0], in.light.background[1], smoothstep(0, 1, height));
  }

  /// The ground becomes the background towards its rim.
  WEIR_HD Vec3f faded(const Vec3f& color, const Vec3f& position, int y) const {
    const float away = length(position - in.ground.middle) / in.ground.radius;
    return mix(color, backgroundAt(y), smoothstep(0.12f, 0.9f, away));
  }

  WEIR_HD Vec3f surfaceAt(int x, int y, std::int64_t k) const {
    constexpr Vec3f kSunColor{0.74f, 0.71f, 0.66f};
    constexpr std::uint32_t kGround = 255;
    const std::uint32_t albedo = in.albedo[k];
    const Vec3f surface{in.linear[albedo & 255u], in.linear[albedo >> 8 & 255u],
                        in.linear[albedo >> 16 & 255u]};
    const bool ground = albedo >> 24 == kGround;
    const Vec3f position = in.camera.ray(x, y) * distanceAt(in.camera, in.depth[k]);
    if (in.light.unlit) return ground ? faded(surface, position, y) : surface;
    const Vec3f normal = normalOf(in.normal[k]);
    const Vec3f towardsEye = -normalized(position);
    const float open = openAt(x, y), facing = dot(normal, in.light.sun);
    const float sun = facing > 0 ? sunlight(position, normal, x, y) : 0.0f;
    const float direct = sun * (facing > 0 ? facing : 0.0f) * mix(1, open, 0.35f);
    const Vec3f color = times(surface, skyLight(normal) * open + kSunColor * direct);
    if (ground) return faded(color, position, y);
    const float cosine = dot(normal, normalized(towardsEye + in.light.sun));
    const float slant = 1 - clamped(dot(normal, towardsEye), 0.0f, 1.0f), square = slant * slant;
    const float rim = 0.04f + 0.96f * square * square * slant;
    return color + kSunColor * (0.10f * sun * highlight(cosine > 0 ? cosine : 0.0f) * 0.25f) +
           times(in.light.sky, surface) * (0.25f * rim * open);
  }

  /// The normalised Blinn-Phong highlight of the exponent 40.
  WEIR_HD static float highlight(float cosine) {
    const float c2 = cosine * cosine, c4 = c2 * c2, c8 = c4 * c4, c16 = c8 * c8;
    return 6 * c16 * c16 * c8;
  }

  WEIR_HD void addLines(int x, int y, float depth, Vec3f& light) const {
    for (std::int64_t i = 0; i < in.lines.size; ++i) {
      const ShadedLine& line = in.lines[i];
      const float right = static_cast<float>(x) + 0.5f - line.from.x;
      const float up = static_cast<float>(y) + 0.5f - line.from.y;
      const float across = right * line.along.y - up * line.along.x;
      if (!(std::fabs(across) <= line.halfWidth)) continue;
      const float along = right * line.along.x + up * line.along.y;
      if (!(along >= 0 && along <= line.length) || line.depth + along * line.depthStep > depth) continue;
      light = mix(light, line.color, line.opacity);
    }
  }

  /// Leaves light below the knee alone, and bends what is above it towards 1.
  WEIR_HD static float shoulder(float light) {
    constexpr float kKnee = 0.8f;
    if (!(light > kKnee)) return light;
    return kKnee + (1 - kKnee) * (1 - std::exp(-(light - kKnee) / (1 - kKnee)));
  }

  WEIR_HD static float encoded(float light) {
    return light < 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1 / 2.4f) - 0.055f;
  }

  WEIR_HD float exposed(float light) const {
    return in.light.unlit ? (light < 1 ? light : 1.0f) : shoulder(light);
  }

  WEIR_HD void operator()(std::int64_t pixel) const {
    const int column = static_cast<int>(pixel % in.width);
    const int row = in.height - 1 - static_cast<int>(pixel / in.width);
    Vec3f sum;
    for (int j = 0; j < in.samples; ++j) {
      const int y = row * in.samples + j;
      for (int i = 0; i < in.samples; ++i) {
        const int x = column * in.samples + i;
        const std::int64_t k = std::int64_t{y} * in.camera.width + x;
        const float depth = in.depth[k];
        Vec3f light = depth >= 1 ? backgroundAt(y) : surfaceAt(x, y, k);
        addLines(x, y, depth, light);
        sum += Vec3f{exposed(light.x), exposed(light.y), exposed(light.z)};
      }
    }
    const float share = 1 / static_cast<float>(in.samples * in.samples);
    for (int c = 0; c < 3; ++c) rgb[3 * pixel + c] = byteOf(encoded(share * sum[c]));
  }
};

}  // namespace

template <class Backend>
void addGround(Backend& device, const SplatCamera& camera, const ShadedGround& ground,
               const SplatTexels& texels) {
  if (ground.visible) parallelFor(device, "ground", texels.depth.size, AddGround{camera, ground, texels});
}

template <class Backend>
void findOcclusion(Backend& device, const ShadedPicture& in, const ShadedOcclusion& occlusion,
                   ArrayView<std::uint8_t> open, ArrayView<std::uint8_t> scratch) {
  parallelFor(device, "occlusion", open.size,
              EstimateOcclusion{in.camera, occlusion, in.samples, in.width, in.depth, in.normal, spiral(),
                                sixteenTurns(), open});
  const auto blur = [&](int stepX, ArrayView<const std::uint8_t> from, ArrayView<std::uint8_t> to) {
    parallelFor(device, "blur occlusion", open.size,
                BlurOcclusion{in.camera, occlusion.radius, in.samples, in.width, in.height, stepX, 1 - stepX,
                              in.depth, from, to});
  };
  blur(1, open, scratch);
  blur(0, scratch, open);
}

template <class Backend>
void shade(Backend& device, const ShadedPicture& picture, ArrayView<std::uint8_t> rgb) {
  parallelFor(device, "shade", std::int64_t{picture.width} * picture.height,
              Shade{picture, softShadow(), rgb});
}

template void addGround(ThisBackend&, const SplatCamera&, const ShadedGround&, const SplatTexels&);
template void findOcclusion(ThisBackend&, const ShadedPicture&, const ShadedOcclusion&,
                            ArrayView<std::uint8_t>, ArrayView<std::uint8_t>);
template void shade(ThisBackend&, const ShadedPicture&, ArrayView<std::uint8_t>);

}  // namespace weir::rendering
