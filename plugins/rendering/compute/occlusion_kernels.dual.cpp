#include "plugins/rendering/compute/occlusion_kernels.h"

#include "framework/compute/parallel.h"
#include "plugins/rendering/compute/pixel_groups.h"
#include "plugins/rendering/shading/formulas.h"
#include "plugins/rendering/shading/patterns.h"

namespace weir::rendering {

namespace {

constexpr int kTaps = OcclusionPattern::kTaps, kTurns = OcclusionPattern::kTurns;

struct EstimateOcclusion {
  SeenSamples seen;
  ShadedOcclusion occlusion;
  PixelGroups pixels;
  int samples;
  OcclusionPattern pattern;
  float* open;
  float* distances;

  WEIR_HD void operator()(std::int64_t k) const {
    const int row = pixels.row(k), y = row * samples + samples / 2;
    const Ints columns = pixels.columns(k), x = columns * samples + samples / 2;
    const SeenRow here = seen.row(x, y);
    const Numbers3 ray = seen.ray(toNumbers(x), Number(static_cast<float>(y)));
    const Number distance = seen.distanceAt(here.depth());
    pixels.store(k, distance, distances);
    const Mask something = here.something();
    if (!any(something)) {
      pixels.store(k, Number(1.0f), open);
      return;
    }
    const Numbers3 position = ray * distance, normal = seen.normal(here, ray);
    const float radius = occlusion.radius;
    const Number reach =
        shading::reachOfOcclusion(distance, radius, occlusion.radiusInView, occlusion.largest);
    const Ints turn = ((columns & 3) * 4 + (row & 3) * 7) & (kTurns - 1);
    Number cosine, sine;
    gatherPairs(&pattern.turns[0].x, turn * 2, cosine, sine);
    cosine *= reach;
    sine *= reach;
    const std::uint64_t* line = seen.nearest.data + std::int64_t{y} * seen.camera.width;
    Number sum = 0.0f;
    for (int i = 0; i < kTaps; ++i) {
      const Vec2<Number> tap = shading::turned(pattern.taps[i], cosine, sine);
      const Ints tapX = clamped(x + nearestInts(tap.x), 0, seen.camera.width - 1);
      const Ints up = clamped(nearestInts(tap.y), -y, seen.camera.height - 1 - y);
      const Number depth = numbersOfBits(gatherUpper(line, up * seen.camera.width + tapX));
      const Numbers3 there = seen.ray(toNumbers(tapX), toNumbers(up + y)) * seen.distanceAt(depth);
      sum += shading::occlusionBy(there - position, normal, radius);
    }
    pixels.store(k, select(something, shading::openSky(sum, kTaps, radius), Number(1.0f)), open);
  }
};

/// Means over neighbours that are about as far away, along one axis.
struct BlurOcclusion {
  PixelGroups pixels;
  float radius;
  int stepX, stepY;
  const float* distances;
  const float* from;
  float* to;

  WEIR_HD void operator()(std::int64_t k) const {
    const int row = pixels.row(k), column = pixels.column(k), width = pixels.width;
    const Number here = rowFrom(distances + std::int64_t{row} * width, column, width);
    Number sum = 0.0f, weights = 0.0f;
    for (int i = -2; i <= 2; ++i) {
      const int wanted = row + i * stepY, x = column + i * stepX;
      const int y = wanted > 0 ? (wanted < pixels.height ? wanted : pixels.height - 1) : 0;
      const std::int64_t start = std::int64_t{y} * width;
      const Number behind = rowFrom(distances + start, x, width) - here;
      const Number weight = shading::weightOfOpenSky(behind, i, radius);
      sum += weight * rowFrom(from + start, x, width);
      weights += weight;
    }
    pixels.store(k, sum / weights, to);
  }
};

}  // namespace

template <class Backend>
void findOcclusion(Backend& device, const SeenSamples& seen, int samples, const ShadedOcclusion& occlusion,
                   ArrayView<float> open, ArrayView<float> scratch, ArrayView<float> distances) {
  const PixelGroups pixels{seen.camera.width / samples, seen.camera.height / samples};
  parallelFor(
      device, "occlusion", pixels.count(),
      EstimateOcclusion{seen, occlusion, pixels, samples, occlusionPattern(), open.data, distances.data});
  const auto blur = [&](int stepX, const float* from, float* to) {
    parallelFor(device, "blur occlusion", pixels.count(),
                BlurOcclusion{pixels, occlusion.radius, stepX, 1 - stepX, distances.data, from, to});
  };
  blur(1, open.data, scratch.data);
  blur(0, scratch.data, open.data);
}

template void findOcclusion(ThisBackend&, const SeenSamples&, int, const ShadedOcclusion&, ArrayView<float>,
                            ArrayView<float>, ArrayView<float>);

}  // namespace weir::rendering
