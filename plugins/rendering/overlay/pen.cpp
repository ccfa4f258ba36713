#include "plugins/rendering/overlay/pen.h"

#include <algorithm>

namespace weir::rendering {
namespace {

constexpr float kHalo = 3;
constexpr Vec3f kDark{0.11f, 0.14f, 0.18f}, kLight{0.97f, 0.97f, 0.97f};

/// Means over `reach` pixels to each side, along the rows or the columns of a mask.
void blurAlong(std::vector<float>& values, int width, int height, int reach, bool rows) {
  const int lines = rows ? height : width, length = rows ? width : height;
  const std::size_t step = rows ? 1 : std::size_t(width), lineStep = rows ? std::size_t(width) : 1;
  std::vector<float> line(static_cast<std::size_t>(length));
  for (int l = 0; l < lines; ++l) {
    float* first = values.data() + std::size_t(l) * lineStep;
    float sum = 0;
    for (int i = -reach; i < length; ++i) {
      if (i + reach < length) sum += first[std::size_t(i + reach) * step];
      if (i - reach - 1 >= 0) sum -= first[std::size_t(i - reach - 1) * step];
      if (i >= 0) line[std::size_t(i)] = sum / float(2 * reach + 1);
    }
    for (int i = 0; i < length; ++i) first[std::size_t(i) * step] = line[std::size_t(i)];
  }
}

template <class F>
void forEach(const TextMask& mask, F f) {
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      f(x, y, float(mask.coverage[std::size_t(y) * std::size_t(mask.width) + std::size_t(x)]) / 255.0f);
}

float distanceToSegment(const Vec2f& p, const Vec2f& a, const Vec2f& b) {
  const float x = b.x - a.x, y = b.y - a.y, square = x * x + y * y;
  const float along = square > 0 ? ((p.x - a.x) * x + (p.y - a.y) * y) / square : 0;
  const float t = std::clamp(along, 0.0f, 1.0f);
  return std::hypot(p.x - a.x - t * x, p.y - a.y - t * y);
}

}  // namespace

Pen::Pen(Picture& picture, bool light)
    : picture_(picture),
      scale_(float(picture.height) / 720.0f),
      ink_(light ? kLight : kDark),
      paper_(light ? kDark : kLight) {}

int Pen::haloReach() const {
  return std::max(1, px(kHalo));
}

void Pen::blend(int x, int y, const Vec3f& color, float opacity) {
  if (x < 0 || y < 0 || x >= picture_.width || y >= picture_.height || opacity <= 0) return;
  const std::size_t place = std::size_t(y) * std::size_t(picture_.width) + std::size_t(x);
  std::uint8_t* pixel = &picture_.rgb[3 * place];
  float share = std::min(opacity, 1.0f);  // of the new colour
  if (!picture_.alpha.empty()) {
    // T. Porter and T. Duff's "over" (1984), for colours that are not multiplied with their opacity.
    const float covered = share + float(picture_.alpha[place]) / 255 * (1 - share);
    picture_.alpha[place] = std::uint8_t(std::lround(255 * covered));
    share /= covered;
  }
  for (int c = 0; c < 3; ++c) {
    const float old = pixel[c];
    pixel[c] = std::uint8_t(std::lround(old + (255 * color[c] - old) * share));
  }
}

void Pen::fill(const Rectangle& area, const Vec3f& color, float opacity) {
  for (int y = area.top; y < area.bottom; ++y)
    for (int x = area.left; x < area.right; ++x) blend(x, y, color, opacity);
}

void Pen::stamp(const TextMask& mask, int left, int top) {
  const int room = 2 * haloReach() + 1;
  const int width = mask.width + 2 * room, height = mask.height + 2 * room;
  std::vector<float> halo(std::size_t(width) * std::size_t(height), 0.0f);
  forEach(mask, [&](int x, int y, float cover) {
    halo[std::size_t(y + room) * std::size_t(width) + std::size_t(x + room)] = cover;
  });
  for (int round = 0; round < 2; ++round)
    for (const bool rows : {true, false}) blurAlong(halo, width, height, haloReach(), rows);
  constexpr float kHaloStrength = 1.5f, kHaloLimit = 0.75f;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      blend(left + x - room, top + y - room, paper_,
            std::min(kHaloLimit, kHaloStrength * halo[std::size_t(y) * std::size_t(width) + std::size_t(x)]));
  forEach(mask, [&](int x, int y, float cover) { blend(left + x, top + y, ink_, cover); });
}

void Pen::curve(const std::vector<Vec2f>& points, float width, const Vec3f& color) {
  if (points.empty()) return;
  const float reach = 0.5f * std::max(1.0f, scaled(width));
  Vec2f low = points.front(), high = low;
  for (const Vec2f& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const int left = int(low.x - reach) - 1, top = int(low.y - reach) - 1;
  const int columns = int(high.x + reach) + 2 - left, rows = int(high.y + reach) + 2 - top;
  // Covered once, however many of the lines meet there.
  std::vector<float> cover(std::size_t(columns) * std::size_t(rows), 0.0f);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2f &a = points[i], &b = points[std::min(i + 1, points.size() - 1)];
    const int fromX = std::max(int(std::min(a.x, b.x) - reach) - 1, left),
              toX = int(std::max(a.x, b.x) + reach) + 1;
    const int fromY = std::max(int(std::min(a.y, b.y) - reach) - 1, top),
              toY = int(std::max(a.y, b.y) + reach) + 1;
    for (int y = fromY; y <= toY; ++y)
      for (int x = fromX; x <= toX; ++x) {
        float& here = cover[std::size_t(y - top) * std::size_t(columns) + std::size_t(x - left)];
        const float away = distanceToSegment({float(x) + 0.5f, float(y) + 0.5f}, a, b);
        here = std::max(here, std::clamp(reach + 0.5f - away, 0.0f, 1.0f));
      }
  }
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      blend(left + x, top + y, color, cover[std::size_t(y) * std::size_t(columns) + std::size_t(x)]);
}

}  // namespace weir::rendering
