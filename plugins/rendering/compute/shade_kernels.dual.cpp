#include "plugins/rendering/compute/shade_kernels.h"

#include <cmath>
#include <numbers>

#include "framework/compute/parallel.h"
#include "plugins/rendering/compute/pixel_groups.h"
#include "plugins/rendering/gl/splat_shapes.h"

namespace weir::rendering {

namespace {

struct ShowGround {
  SeenSamples seen;
  PixelGroups samples;
  ArrayView<std::uint64_t> nearest;

  WEIR_HD Number depthsAlong(const Numbers3& ray) const {
    const ShadedGround& ground = seen.ground;
    const float height = dot(ground.middle, ground.up);
    const Number falling = dot(ray, allOf(ground.up));
    if (!ground.visible || !(height < 0) || !any(falling < Number(0.0f))) return Number(1.0f);
    const Number distance = height / falling;
    const Numbers3 aside = ray * distance - allOf(ground.middle);
    const Mask outside =
        either(distance<Number(seen.camera.near), dot(aside, aside)> Number(ground.radius * ground.radius));
    const Number depth = atMost(
        positivePart(0.5f + 0.5f * (seen.camera.projection.w / distance - seen.camera.projection.z)), 1.0f);
    return select(notSo(outside) & (falling < Number(0.0f)), depth, Number(1.0f));
  }

  WEIR_HD void operator()(std::int64_t k) const {
    const int row = samples.row(k), first = samples.column(k);
    const Number x = toNumbers(intsFrom(first));
    const Ints bits = bitsOfNumbers(depthsAlong(seen.ray(x, Number(static_cast<float>(row)))));
    std::uint64_t* to = nearest.data + std::int64_t{row} * samples.width + first;
    for (int l = 0; l < kPixels; ++l)
      if (first + l < samples.width) to[l] = std::uint64_t{laneOf(bits, l)} << 32 | gl::kNoSphere;
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
  PixelGroups pixels;
  SoftShadow soft;
  ArrayView<std::uint8_t> rgb;

  /// Two neighbouring texels of the shadow map against depths, mixed: 1 where they are lit. `left` is the
  /// column of the first, which may lie outside.
  WEIR_HD Number areLit(const Ints& left, const Ints& row, const Number& beyond, const Number& depth) const {
    const int last = in.light.shadowResolution - 1;
    Number first, second;
    gatherPairs(in.shadow.data,
                clamped(row, 0, last) * in.light.shadowResolution + clamped(left, 0, last - 1), first,
                second);
    const Number one = select(below(left, last), first, second), two = select(below(left, 0), first, second);
    return mix(select(one < depth, Number(0.0f), Number(1.0f)),
               select(two < depth, Number(0.0f), Number(1.0f)), beyond);
  }

  /// The comparisons of the four texels around a place, mixed.
  WEIR_HD Number litAt(const Number& u, const Number& v, const Number& depth) const {
    const auto size = static_cast<float>(in.light.shadowResolution);
    Number right, up;
    const Ints column = split(clamped(u * size - 0.5f, -1.0f, size), right);
    const Ints row = split(clamped(v * size - 0.5f, -1.0f, size), up);
    return mix(areLit(column, row, right, depth), areLit(column, row + 1, right, depth), up);
  }

  /// Whether places are lit, as far as the tiles know; true if they know it of all that are `wanted`.
  WEIR_HD bool knowTiles(const Number& u, const Number& v, const Number& depth, const Mask& wanted,
                         Number& lit) const {
    constexpr float kSide = ShadowTiles::kSide;
    const float tiles = static_cast<float>(in.light.shadowResolution) / kSide;
    const auto last = static_cast<float>(in.tiles.perRow - 1);
    const Ints at =
        toInts(clamped(v * tiles, 0.0f, last)) * in.tiles.perRow + toInts(clamped(u * tiles, 0.0f, last));
    const Mask dark = gather(in.tiles.farthest.data, at) < depth;
    const Mask unsure = gather(in.tiles.nearest.data, at) < depth;
    lit = select(dark, Number(0.0f), Number(1.0f));
    return !any(wanted & unsure & notSo(dark));
  }

  WEIR_HD Number sunlight(const Numbers3& position, const Numbers3& normal, const Ints& x, int y,
                          const Mask& wanted) const {
    const ShadedLight& light = in.light;
    if (light.shadowResolution == 0) return Number(1.0f);
    const Numbers3 p = position + normal * Number(light.shadowTexel * 2);
    const Number u = dot(allOf(light.toShadow[0]), p) + light.shadowMoved.x;
    const Number v = dot(allOf(light.toShadow[1]), p) + light.shadowMoved.y;
    const Number depth = atMost(dot(allOf(light.toShadow[2]), p) + light.shadowMoved.z, 1.0f);
    Number open = 0.0f;
    if (knowTiles(u, v, depth, wanted, open)) return open;
    open = 0.0f;
    const Mask even = equal(x & 1, 0);
    const Vec2f first = soft.turns[2 * (y & 1)], second = soft.turns[1 + 2 * (y & 1)];
    const Number turnX = light.softness * select(even, Number(first.x), Number(second.x));
    const Number turnY = light.softness * select(even, Number(first.y), Number(second.y));
    for (int i = 0; i < 4; ++i) {
      const Vec2f tap = soft.taps[i];
      open += 0.25f * litAt(u + tap.x * turnX - tap.y * turnY, v + tap.x * turnY + tap.y * turnX, depth);
    }
    return open;
  }

  WEIR_HD Numbers3 skyLight(const Numbers3& normal) const {
    constexpr float kStrength = 0.56f;
    const Number above = 0.5f + 0.5f * dot(normal, allOf(in.light.up));
    return mix(allOf(kStrength * 0.62f * in.light.ground), allOf(kStrength * in.light.sky),
               above * (2 - above));
  }

  /// The occlusion at samples, mixed of the four pixels around each. `column` is of the first pixel.
  WEIR_HD Number openAt(int column, int row, int right, int up) const {
    if (in.open.size == 0) return Number(1.0f);
    // From the middle of the sample's pixel, in pixels.
    const float asideX = (static_cast<float>(right) + 0.5f) / static_cast<float>(in.samples) - 0.5f;
    const float asideY = (static_cast<float>(up) + 0.5f) / static_cast<float>(in.samples) - 0.5f;
    const int other = asideY < 0 ? (row > 0 ? row - 1 : 0) : (row + 1 < in.height ? row + 1 : row);
    const int next = column + (asideX < 0 ? -1 : 1);
    const auto along = [&](int of) {
      const float* line = in.open.data + std::int64_t{of} * in.width;
      return mix(rowFrom(line, column, in.width), rowFrom(line, next, in.width), std::fabs(asideX));
    };
    return mix(along(row), along(other), std::fabs(asideY));
  }

  WEIR_HD Vec3f backgroundAt(int y) const {
    float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(in.seen.camera.height);
    t = t * t * (3 - 2 * t);
    return in.light.background[0] + (in.light.background[1] - in.light.background[0]) * t;
  }

  /// The ground becomes the background towards its rim.
  WEIR_HD Numbers3 faded(const Numbers3& color, const Numbers3& position, int y) const {
    const Numbers3 aside = position - allOf(in.seen.ground.middle);
    const Number away = sqrtf(dot(aside, aside)) / in.seen.ground.radius;
    return mix(color, allOf(backgroundAt(y)), smoothstep(0.12f, 0.9f, away));
  }

  WEIR_HD Numbers3 albedo(const SeenRow& seen, const Mask& ground) const {
    const Numbers3 groundColor = allOf(in.seen.ground.color);
    if (!any(notSo(ground))) return groundColor;
    const Ints packed = in.seen.sphereColors(seen);
    const Numbers3 color{gather(in.linear.data, packed & 255), gather(in.linear.data, (packed >> 8) & 255),
                         gather(in.linear.data, (packed >> 16) & 255)};
    return selectAll(ground, groundColor, color);
  }

  /// The light from surfaces; anything where there is none. `column` and `row` are of the first pixel,
  /// `right` and `up` count the sample in them.
  WEIR_HD Numbers3 surfaceAt(const SeenRow& seen, const Ints& x, int column, int row, int right,
                             int up) const {
    constexpr Vec3f kSunColor{0.74f, 0.71f, 0.66f};
    const int y = row * in.samples + up;
    const Mask ground = seen.ground();
    const Numbers3 surface = albedo(seen, ground);
    const Numbers3 ray = in.seen.ray(toNumbers(x), Number(static_cast<float>(y)));
    const Numbers3 position = ray * in.seen.distanceAt(seen.depth());
    if (in.light.unlit)
      return any(ground) ? selectAll(ground, faded(surface, position, y), surface) : surface;
    const Numbers3 normal = in.seen.normal(seen, ray);
    const Number open = openAt(column, row, right, up);
    const Number facing = positivePart(dot(normal, allOf(in.light.sun)));
    const Mask sunny = (facing > Number(0.0f)) & seen.something();
    const Number sun =
        any(sunny) ? select(facing > Number(0.0f), sunlight(position, normal, x, y, sunny), Number(0.0f))
                   : Number(0.0f);
    const Numbers3 sunColor = allOf(kSunColor);
    const Number direct = sun * facing * (1 + (open - 1) * 0.35f);
    const Numbers3 color = times(surface, skyLight(normal) * open + sunColor * direct);
    if (!any(notSo(ground))) return faded(color, position, y);
    const Numbers3 towardsEye = unit(-position);
    const Number cosine = positivePart(dot(normal, unit(towardsEye + allOf(in.light.sun))));
    const Number slant = 1 - clamped(dot(normal, towardsEye), 0.0f, 1.0f), square = slant * slant;
    const Number rim = 0.04f + 0.96f * square * square * slant;
    const Numbers3 shiny = color + sunColor * (0.10f * 0.25f * sun * highlight(cosine)) +
                           times(allOf(in.light.sky), surface) * (0.25f * rim * open);
    return any(ground) ? selectAll(ground, faded(color, position, y), shiny) : shiny;
  }

  /// The normalised Blinn-Phong highlight of the exponent 40.
  WEIR_HD static Number highlight(const Number& cosine) {
    const Number c2 = cosine * cosine, c4 = c2 * c2, c8 = c4 * c4, c16 = c8 * c8;
    return 6 * c16 * c16 * c8;
  }

  /// Which of the lines come near the pixels, one bit each.
  struct NearLines {
    std::uint32_t bits[kMaxLines / 32] = {};
    bool any = false;
  };
  WEIR_HD NearLines linesAt(int column, int row) const {
    NearLines found;
    const float half = 0.5f * static_cast<float>(in.samples);
    const float halfWidth = half * kPixels;
    const float x = static_cast<float>(column * in.samples) + halfWidth;
    const float y = static_cast<float>(row * in.samples) + half;
    for (int i = 0; i < static_cast<int>(in.lines.size); ++i) {
      const ShadedLine& line = in.lines[i];
      if (y + half < line.lowest || y - half > line.highest) continue;
      const float right = x - line.from.x, up = y - line.from.y;
      const float alongX = std::fabs(line.along.x), alongY = std::fabs(line.along.y);
      const float across =
          std::fabs(right * line.along.y - up * line.along.x) - halfWidth * alongY - half * alongX;
      if (across > line.halfWidth) continue;
      const float along = right * line.along.x + up * line.along.y,
                  reach = halfWidth * alongX + half * alongY;
      if (along + reach < 0 || along - reach > line.length) continue;
      found.bits[i / 32] |= 1u << (i % 32);
      found.any = true;
    }
    return found;
  }

  WEIR_HD Numbers3 withLines(Numbers3 light, const NearLines& near, const Number& x, float y,
                             const Number& depth) const {
    for (int i = 0; i < static_cast<int>(in.lines.size); ++i) {
      if ((near.bits[i / 32] >> (i % 32) & 1u) == 0) continue;
      const ShadedLine& line = in.lines[i];
      const Number right = x + 0.5f - line.from.x;
      const float up = y + 0.5f - line.from.y;
      const Number across = right * line.along.y - up * line.along.x;
      const Number along = right * line.along.x + up * line.along.y;
      const Mask outside = either(either(Number(line.halfWidth) < across, across < Number(-line.halfWidth)),
                                  either(either(along<Number(0.0f), along> Number(line.length)),
                                         depth < line.depth + along * line.depthStep));
      light = selectAll(outside, light, mix(light, allOf(line.color), line.opacity));
    }
    return light;
  }

  /// Leaves light below the knee alone, and bends what is above it towards 1.
  WEIR_HD static Number shoulder(const Number& light) {
    constexpr float kKnee = 0.8f, kMax = 80;
    const Mask above = light > Number(kKnee);
    if (!any(above)) return light;
    const Number over = clamped((light - kKnee) * (1 / (1 - kKnee)), 0.0f, kMax);
    return select(above, 1 - (1 - kKnee) * exponential(-over), light);
  }

  WEIR_HD static Number encoded(const Number& light) {
    constexpr float kLinear = 0.0031308f;
    const Number bent = 1.055f * power(atLeast(light, kLinear), 1 / 2.4f) - 0.055f;
    return select(light < Number(kLinear), 12.92f * light, bent);
  }

  WEIR_HD Numbers3 exposed(const Numbers3& light) const {
    if (in.light.unlit) return {atMost(light.x, 1.0f), atMost(light.y, 1.0f), atMost(light.z, 1.0f)};
    return {shoulder(light.x), shoulder(light.y), shoulder(light.z)};
  }

  WEIR_HD void operator()(std::int64_t k) const {
    const Ints columns = pixels.columns(k);
    const int row = in.height - 1 - pixels.row(k);
    const NearLines near = linesAt(pixels.column(k), row);
    Numbers3 sum = allOf({0, 0, 0});
    for (int j = 0; j < in.samples; ++j) {
      const int y = row * in.samples + j;
      const Numbers3 background = allOf(backgroundAt(y));
      for (int i = 0; i < in.samples; ++i) {
        const Ints x = columns * in.samples + i;
        const SeenRow seen = in.seen.row(x, y);
        const Mask something = seen.something();
        Numbers3 light = background;
        if (any(something))
          light = selectAll(something, surfaceAt(seen, x, pixels.column(k), row, i, j), background);
        if (near.any) light = withLines(light, near, toNumbers(x), static_cast<float>(y), seen.depth());
        sum += exposed(light);
      }
    }
    write(k, sum * Number(1 / static_cast<float>(in.samples * in.samples)));
  }

  WEIR_HD void write(std::int64_t k, const Numbers3& light) const {
    const Ints red = bytesOf(encoded(light.x)), green = bytesOf(encoded(light.y)),
               blue = bytesOf(encoded(light.z));
    const int first = pixels.column(k);
    std::uint8_t* to = rgb.data + 3 * (std::int64_t{pixels.row(k)} * in.width + first);
    for (int l = 0; l < kPixels && first + l < in.width; ++l) {
      to[3 * l] = static_cast<std::uint8_t>(laneOf(red, l));
      to[3 * l + 1] = static_cast<std::uint8_t>(laneOf(green, l));
      to[3 * l + 2] = static_cast<std::uint8_t>(laneOf(blue, l));
    }
  }
};

}  // namespace

template <class Backend>
void showGround(Backend& device, const SeenSamples& seen, ArrayView<std::uint64_t> nearest) {
  const PixelGroups samples{seen.camera.width, seen.camera.height};
  parallelFor(device, "ground", samples.count(), ShowGround{seen, samples, nearest});
}

template <class Backend>
void shade(Backend& device, const ShadedPicture& picture, ArrayView<std::uint8_t> rgb) {
  const PixelGroups pixels{picture.width, picture.height};
  parallelFor(device, "shade", pixels.count(), Shade{picture, pixels, softShadow(), rgb});
}

template void showGround(ThisBackend&, const SeenSamples&, ArrayView<std::uint64_t>);
template void shade(ThisBackend&, const ShadedPicture&, ArrayView<std::uint8_t>);

}  // namespace weir::rendering
