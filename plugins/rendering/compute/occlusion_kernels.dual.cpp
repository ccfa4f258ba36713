#include "plugins/rendering/compute/occlusion_kernels.h"

#include <cmath>
#include <numbers>

#include "framework/compute/parallel.h"
#include "plugins/rendering/compute/pixel_groups.h"

namespace weir::rendering {

namespace {

/// Eleven places of a spiral of seven turns, a number without a common factor, and cosine and sine of the
/// sixteen angles by which pixels turn them.
constexpr int kTaps = 11, kTurns = 16;
struct Taps {
  Vec2f at[kTaps];
  float cosine[kTurns], sine[kTurns];
};

Taps spiral() {
  constexpr float kAround = 7, kCircle = 2 * std::numbers::pi_v<float>;
  Taps taps;
  for (int i = 0; i < kTaps; ++i) {
    const float part = (static_cast<float>(i) + 0.5f) / kTaps;
    taps.at[i] = {part * std::cos(kCircle * kAround * part), part * std::sin(kCircle * kAround * part)};
  }
  for (int i = 0; i < kTurns; ++i) {
    const float angle = static_cast<float>(i) * (kCircle / kTurns);
    taps.cosine[i] = std::cos(angle);
    taps.sine[i] = std::sin(angle);
  }
  return taps;
}

struct EstimateOcclusion {
  SeenSamples seen;
  ShadedOcclusion occlusion;
  PixelGroups pixels;
  int samples;
  Taps taps;
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
    const float radius = occlusion.radius, square = radius * radius;
    const Number reach = atMost(radius * occlusion.radiusInView / distance, occlusion.largest);
    const Ints turn = ((columns & 3) * 4 + (row & 3) * 7) & (kTurns - 1);
    const Number cosine = reach * gather(taps.cosine, turn), sine = reach * gather(taps.sine, turn);
    const std::uint64_t* line = seen.nearest.data + std::int64_t{y} * seen.camera.width;
    Number sum = 0.0f;
    for (int i = 0; i < kTaps; ++i) {
      const Vec2f tap = taps.at[i];
      const Ints tapX = clamped(x + nearestInts(tap.x * cosine - tap.y * sine), 0, seen.camera.width - 1);
      const Ints up = clamped(nearestInts(tap.x * sine + tap.y * cosine), -y, seen.camera.height - 1 - y);
      const Number depth = numbersOfBits(gatherUpper(line, up * seen.camera.width + tapX));
      const Numbers3 there = seen.ray(toNumbers(tapX), toNumbers(up + y)) * seen.distanceAt(depth);
      const Numbers3 towards = there - position;
      const Number way = dot(towards, towards);
      const Number within = positivePart(square - way);
      const Number over = positivePart(dot(towards, normal) - 0.02f * radius);
      sum += within * within * within * over / (way + 1e-3f * square);
    }
    const Number hemmedIn = sum * (5 / (square * square * radius * static_cast<float>(kTaps)));
    pixels.store(k, select(something, positivePart(1 - hemmedIn), Number(1.0f)), open);
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
      const Number away = (rowFrom(distances + start, x, width) - here) * (2 / radius);
      const Number weight = (i == -2 || i == 2 ? 0.5f : 1.0f) * positivePart(1 - away * away);
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
  parallelFor(device, "occlusion", pixels.count(),
              EstimateOcclusion{seen, occlusion, pixels, samples, spiral(), open.data, distances.data});
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
