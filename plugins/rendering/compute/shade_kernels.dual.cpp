#include "plugins/rendering/compute/shade_kernels.h"

#include <cmath>

#include "framework/compute/parallel.h"
#include "plugins/rendering/compute/pixel_groups.h"
#include "plugins/rendering/shading/formulas.h"
#include "plugins/rendering/shading/patterns.h"

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
        (distance < Number(seen.camera.near)) | (dot(aside, aside) > Number(ground.radius * ground.radius));
    const Number depth = atMost(positivePart(seen.camera.depthAt(distance)), 1.0f);
    return select((falling < Number(0.0f)) & !outside, depth, Number(1.0f));
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

struct Shade {
  ShadedPicture in;
  PixelGroups pixels;
  ShadowPattern pattern;
  ArrayView<std::uint8_t> rgb;

  /// Two neighbouring texels of the shadow map against depths, mixed: 1 where they are lit. `left` is the
  /// column of the first, which may lie outside.
  WEIR_HD Number areLit(const Ints& left, const Ints& row, const Number& beyond, const Number& depth) const {
    const int last = in.shadowMap.resolution - 1;
    Number first, second;
    gatherPairs(in.shadow.data, clamped(row, 0, last) * in.shadowMap.resolution + clamped(left, 0, last - 1),
                first, second);
    const Number one = select(below(left, last), first, second), two = select(below(left, 0), first, second);
    return mix(select(one < depth, Number(0.0f), Number(1.0f)),
               select(two < depth, Number(0.0f), Number(1.0f)), beyond);
  }

  /// The comparisons of the four texels around a place, mixed.
  WEIR_HD Number litAt(const Number& u, const Number& v, const Number& depth) const {
    const auto size = static_cast<float>(in.shadowMap.resolution);
    Number right, up;
    const Ints column = split(clamped(u * size - 0.5f, -1.0f, size), right);
    const Ints row = split(clamped(v * size - 0.5f, -1.0f, size), up);
    return mix(areLit(column, row, right, depth), areLit(column, row + 1, right, depth), up);
  }

  /// Whether places are lit, as far as the tiles know; true if they know it of all that are `wanted`.
  WEIR_HD bool knowTiles(const Number& u, const Number& v, const Number& depth, const Mask& wanted,
                         Number& lit) const {
    constexpr float kSide = ShadowTiles::kSide;
    const float tiles = static_cast<float>(in.shadowMap.resolution) / kSide;
    const auto last = static_cast<float>(in.tiles.perRow - 1);
    const Ints at =
        toInts(clamped(v * tiles, 0.0f, last)) * in.tiles.perRow + toInts(clamped(u * tiles, 0.0f, last));
    Number nearest, farthest;
    gatherPairs(&in.tiles.depths.data->x, at * 2, nearest, farthest);
    const Mask dark = farthest < depth;
    lit = select(dark, Number(0.0f), Number(1.0f));
    return !any(wanted & (nearest < depth) & (!dark));
  }

  WEIR_HD Number sunlight(const Numbers3& position, const Numbers3& normal, const Ints& x, int y,
                          const Mask& wanted) const {
    const ShadedLight& light = in.light;
    if (in.shadowMap.resolution == 0) return Number(1.0f);
    const Numbers3 p = position + normal * Number(light.shadowTexel * shading::kShadowOffset);
    const Numbers3 place = in.shadowMap.toMap.point(p);
    const Number u = place.x, v = place.y, depth = atMost(place.z, 1.0f);
    Number open = 0.0f;
    if (knowTiles(u, v, depth, wanted, open)) return open;
    open = 0.0f;
    const Mask even = equal(x & 1, 0);
    const Vec2f first = pattern.turns[2 * (y & 1)], second = pattern.turns[1 + 2 * (y & 1)];
    const Number turnX = light.softness * select(even, Number(first.x), Number(second.x));
    const Number turnY = light.softness * select(even, Number(first.y), Number(second.y));
    for (int i = 0; i < 4; ++i) {
      const Vec2<Number> tap = shading::turned(pattern.taps[i], turnX, turnY);
      open += 0.25f * litAt(u + tap.x, v + tap.y, depth);
    }
    return open;
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

  WEIR_HD Numbers3 backgroundAt(int y) const {
    const float height = (static_cast<float>(y) + 0.5f) / static_cast<float>(in.seen.camera.height);
    return shading::backgroundOf(Number(height), allOf(in.light.background[0]),
                                 allOf(in.light.background[1]));
  }

  /// The ground becomes the background towards its rim.
  WEIR_HD Numbers3 faded(const Numbers3& color, const Numbers3& position, int y) const {
    const Numbers3 aside = position - allOf(in.seen.ground.middle);
    return mix(color, backgroundAt(y),
               shading::fadeOfGround(sqrtf(dot(aside, aside)), in.seen.ground.radius));
  }

  /// And which are white water.
  WEIR_HD Numbers3 albedo(const SeenRow& seen, const Mask& ground, Mask& white) const {
    const Numbers3 groundColor = allOf(in.seen.ground.color);
    white = ground & !ground;
    if (!any(!ground)) return groundColor;
    const Ints packed = in.seen.sphereColors(seen);
    white = (!ground) & equal((packed >> 24) & 255, static_cast<int>(255 * shading::kWhite + 0.5f));
    const Numbers3 color{gather(in.linear.data, packed & 255), gather(in.linear.data, (packed >> 8) & 255),
                         gather(in.linear.data, (packed >> 16) & 255)};
    return select(ground, groundColor, color);
  }

  /// The light from surfaces; anything where there is none. `column` and `row` are of the first pixel,
  /// `right` and `up` count the sample in them.
  WEIR_HD Numbers3 surfaceAt(const SeenRow& seen, const Ints& x, int column, int row, int right,
                             int up) const {
    const int y = row * in.samples + up;
    const Mask ground = seen.ground();
    Mask white;
    const Numbers3 surface = albedo(seen, ground, white);
    const Numbers3 ray = in.seen.ray(toNumbers(x), Number(static_cast<float>(y)));
    const Numbers3 position = ray * in.seen.distanceAt(seen.depth());
    if (in.light.unlit) return any(ground) ? select(ground, faded(surface, position, y), surface) : surface;
    const Numbers3 normal = in.seen.normal(seen, ray);
    const Number open = openAt(column, row, right, up);
    const Number facing = positivePart(dot(normal, allOf(in.light.sun)));
    const Mask turned = (facing > Number(0.0f)) | white, sunny = turned & seen.something();
    const Number sun =
        any(sunny) ? select(turned, sunlight(position, normal, x, y, sunny), Number(0.0f)) : Number(0.0f);
    const Numbers3 sunColor = allOf(in.light.sunColor);
    const Numbers3 sky =
        shading::skyLightOf(normal, allOf(in.light.up), allOf(in.light.skyBelow), allOf(in.light.skyAbove));
    const Numbers3 color = times(surface, shading::diffuseLight(sky, open, sunColor, sun, facing));
    if (!any(!ground)) return faded(color, position, y);
    const Numbers3 towardsEye = unit(-position);
    const Number cosine = positivePart(dot(normal, unit(towardsEye + allOf(in.light.sun))));
    Numbers3 light = shading::withShine(color, surface, allOf(in.light.sky), open, sunColor, sun, cosine,
                                        dot(normal, towardsEye));
    if (any(white)) {
      const Numbers3 froth = shading::frothLight(allOf(in.light.skyAbove), sunColor, sun);
      light = select(white, times(surface, froth), light);
    }
    return any(ground) ? select(ground, faded(color, position, y), light) : light;
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
      const Mask outside = (Number(line.halfWidth) < across) | (across < Number(-line.halfWidth)) |
                           (along < Number(0.0f)) | (Number(line.length) < along) |
                           (depth < line.depth + along * line.depthStep);
      light = select(outside, light, mix(light, allOf(line.color), line.opacity));
    }
    return light;
  }

  WEIR_HD static Number shoulder(const Number& light) {
    return any(light > Number(shading::kKnee)) ? shading::shoulder(light) : light;
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
      const Numbers3 background = backgroundAt(y);
      for (int i = 0; i < in.samples; ++i) {
        const Ints x = columns * in.samples + i;
        const SeenRow seen = in.seen.row(x, y);
        const Mask something = seen.something();
        Numbers3 light = background;
        if (any(something))
          light = select(something, surfaceAt(seen, x, pixels.column(k), row, i, j), background);
        if (near.any) light = withLines(light, near, toNumbers(x), static_cast<float>(y), seen.depth());
        sum += exposed(light);
      }
    }
    write(k, sum * Number(1 / static_cast<float>(in.samples * in.samples)));
  }

  WEIR_HD void write(std::int64_t k, const Numbers3& light) const {
    const Ints red = bytesOf(shading::encoded(light.x)), green = bytesOf(shading::encoded(light.y)),
               blue = bytesOf(shading::encoded(light.z));
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
  parallelFor(device, "shade", pixels.count(), Shade{picture, pixels, shadowPattern(), rgb});
}

template void showGround(ThisBackend&, const SeenSamples&, ArrayView<std::uint64_t>);
template void shade(ThisBackend&, const ShadedPicture&, ArrayView<std::uint8_t>);

}  // namespace weir::rendering
