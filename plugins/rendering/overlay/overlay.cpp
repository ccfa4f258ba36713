#include "plugins/rendering/overlay/overlay.h"

#include <algorithm>
#include <cmath>

#include "plugins/rendering/overlay/pen.h"
#include "plugins/rendering/overlay/ticks.h"

namespace weir::rendering {
namespace {

// Lengths in pixels of a picture that is 720 pixels high.
constexpr float kMargin = 28, kTitleSize = 25, kTimeSize = 20, kSmallSize = 15.5f;
constexpr float kBarWidth = 14, kBarHeight = 260, kTickLength = 5, kGap = 7;
constexpr int kTicks = 5;

void drawBar(Pen& pen, Font& font, const ColorBar& bar) {
  const int right = pen.picture().width - pen.px(kMargin), left = right - std::max(2, pen.px(kBarWidth));
  const TextMask caption = font.write(bar.caption, pen.scaled(kSmallSize));
  const int top = pen.px(kMargin + 2 * kGap) + caption.height, height = std::max(4, pen.px(kBarHeight));
  pen.stamp(caption, right - caption.width, pen.px(kMargin));

  const int frame = std::max(1, pen.px(1));
  pen.fill({left - frame, top - frame, right + frame, top + height + frame}, pen.ink(), 0.55f);
  for (int y = 0; y < height; ++y) {
    const float t = 1 - (float(y) + 0.5f) / float(height);
    pen.fill({left, top + y, right, top + y + 1}, bar.map.at(t), 1);
  }
  const double range = double(bar.highest) - double(bar.lowest);
  for (const Tick& tick : roundTicks(bar.lowest, bar.highest, kTicks)) {
    const double part = range > 0 ? (tick.value - bar.lowest) / range : 0.5;
    const int y = top + int(std::lround((1 - part) * (height - 1)));
    pen.fill({left - frame - pen.px(kTickLength), y, left - frame, y + frame}, pen.ink(), 0.9f);
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
  for (std::size_t i = 0; i < text.plots.size(); ++i) drawPlot(pen, regular_, text.plots[i], int(i));
}

}  // namespace weir::rendering
