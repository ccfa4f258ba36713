#include "plugins/rendering/overlay/overlay.h"

#include <algorithm>
#include <cmath>

#include "plugins/rendering/overlay/ticks.h"

namespace weir::rendering {
namespace {

// Lengths in pixels of a picture that is 720 pixels high.
constexpr float kMargin = 28, kTitleSize = 25, kTimeSize = 20, kSmallSize = 15.5f, kHalo = 3;
constexpr float kBarWidth = 14, kBarHeight = 260, kTickLength = 5, kGap = 7;
constexpr int kTicks = 5;

constexpr Vec3f kDark{0.11f, 0.14f, 0.18f}, kLight{0.97f, 0.97f, 0.97f};

struct Rectangle {
  int left, top, right, bottom;  // the last two are the first pixel beyond
};

/// Mixes `opacity` of a colour into a pixel; a place outside is passed over.
void blend(Picture& picture, int x, int y, const Vec3f& color, float opacity) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height || opacity <= 0) return;
  std::uint8_t* pixel = &picture.rgb[3 * (std::size_t(y) * std::size_t(picture.width) + std::size_t(x))];
  for (int c = 0; c < 3; ++c) {
    const float old = pixel[c];
    pixel[c] = std::uint8_t(std::lround(old + (255 * color[c] - old) * std::min(opacity, 1.0f)));
  }
}

void fill(Picture& picture, const Rectangle& area, const Vec3f& color, float opacity) {
  for (int y = area.top; y < area.bottom; ++y)
    for (int x = area.left; x < area.right; ++x) blend(picture, x, y, color, opacity);
}

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

/// What one call of Overlay::draw works with.
class Pen {
 public:
  Pen(Picture& picture, bool light)
      : picture_(picture),
        scale_(float(picture.height) / 720.0f),
        ink_(light ? kLight : kDark),
        haloColor_(light ? kDark : kLight) {}

  int px(float length) const { return int(std::lround(length * scale_)); }
  float scaled(float size) const { return size * scale_; }
  Picture& picture() { return picture_; }
  const Vec3f& ink() const { return ink_; }

  /// With a soft edge in the opposite brightness, so that it can be read on everything.
  void stamp(const TextMask& mask, int left, int top) {
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
        blend(
            picture_, left + x - room, top + y - room, haloColor_,
            std::min(kHaloLimit, kHaloStrength * halo[std::size_t(y) * std::size_t(width) + std::size_t(x)]));
    forEach(mask, [&](int x, int y, float cover) { blend(picture_, left + x, top + y, ink_, cover); });
  }

 private:
  int haloReach() const { return std::max(1, px(kHalo)); }

  template <class F>
  static void forEach(const TextMask& mask, F f) {
    for (int y = 0; y < mask.height; ++y)
      for (int x = 0; x < mask.width; ++x)
        f(x, y, float(mask.coverage[std::size_t(y) * std::size_t(mask.width) + std::size_t(x)]) / 255.0f);
  }

  Picture& picture_;
  float scale_;
  Vec3f ink_, haloColor_;
};

void drawBar(Pen& pen, Font& font, const ColorBar& bar) {
  Picture& picture = pen.picture();
  const int right = picture.width - pen.px(kMargin), left = right - std::max(2, pen.px(kBarWidth));
  const TextMask caption = font.write(bar.caption, pen.scaled(kSmallSize));
  const int top = pen.px(kMargin + 2 * kGap) + caption.height, height = std::max(4, pen.px(kBarHeight));
  pen.stamp(caption, right - caption.width, pen.px(kMargin));

  const int frame = std::max(1, pen.px(1));
  fill(picture, {left - frame, top - frame, right + frame, top + height + frame}, pen.ink(), 0.55f);
  for (int y = 0; y < height; ++y) {
    const float t = 1 - (float(y) + 0.5f) / float(height);
    fill(picture, {left, top + y, right, top + y + 1}, bar.map.at(t), 1);
  }
  const double range = double(bar.highest) - double(bar.lowest);
  for (const Tick& tick : roundTicks(bar.lowest, bar.highest, kTicks)) {
    const double part = range > 0 ? (tick.value - bar.lowest) / range : 0.5;
    const int y = top + int(std::lround((1 - part) * (height - 1)));
    fill(picture, {left - frame - pen.px(kTickLength), y, left - frame, y + frame}, pen.ink(), 0.9f);
    const TextMask label = font.write(tick.label, pen.scaled(kSmallSize));
    pen.stamp(label, left - pen.px(kTickLength + kGap) - label.width, y - label.height / 2);
  }
}

}  // namespace

bool wantsLightText(const Color& backgroundTop, const Color& backgroundBottom) {
  const auto luma = [](const Color& c) { return 0.299f * c.r + 0.587f * c.g + 0.114f * c.b; };
  return luma(backgroundTop) + luma(backgroundBottom) < 0.9f;
}

Overlay::Overlay(const std::filesystem::path& fontFolder)
    : regular_(fontFolder / "DejaVuSans.ttf"), bold_(fontFolder / "DejaVuSans-Bold.ttf") {}

void Overlay::draw(const OverlayText& text, Picture& picture) {
  Pen pen(picture, text.lightText);
  int y = pen.px(kMargin) - pen.px(4);  // letters are lower than their line
  const auto line = [&](Font& font, const std::string& words, float size, float gap) {
    const TextMask mask = font.write(words, pen.scaled(size));
    pen.stamp(mask, pen.px(kMargin), y);
    y += mask.height + pen.px(gap);
  };
  if (!text.title.empty()) line(bold_, text.title, kTitleSize, 4);
  if (text.seconds) line(regular_, timeText(*text.seconds), kTimeSize, 2);
  if (text.particles) line(regular_, particleText(*text.particles), kSmallSize, 2);
  if (text.bar) drawBar(pen, regular_, *text.bar);
}

}  // namespace weir::rendering
