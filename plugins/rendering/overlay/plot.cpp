#include "plugins/rendering/overlay/plot.h"

#include <algorithm>
#include <cmath>

#include "plugins/rendering/overlay/ticks.h"

namespace weir::rendering {
namespace {

// Lengths in pixels of a picture that is 720 pixels high.
constexpr float kMargin = 28, kWidth = 300, kHeight = 168, kGap = 18;
constexpr float kLeft = 58, kRight = 16, kTop = 32, kBottom = 27;  // room around the curve
constexpr float kTextSize = 13, kCaptionSize = 14.5f, kTick = 4, kCurve = 2.2f;
constexpr int kTicks = 4, kTimeTicks = 3;

struct Range {
  double low = 0, high = 1;
  double part(double x) const { return (x - low) / (high - low); }
};

/// From the least to the greatest value, with zero if that is no farther away than they are from each other.
Range rangeOf(const std::vector<PlotPoint>& points) {
  bool any = false;
  Range range;
  for (const PlotPoint& point : points) {
    if (!std::isfinite(point.value)) continue;
    range.low = any ? std::min(range.low, point.value) : point.value;
    range.high = any ? std::max(range.high, point.value) : point.value;
    any = true;
  }
  if (!any) return {};
  const double size = range.high - range.low;
  if (range.low > 0 && range.low <= size) range.low = 0;
  if (range.high < 0 && -range.high <= size) range.high = 0;
  constexpr double kRoom = 0.05, kFlat = 1e-6;
  const double min = kFlat * std::max(std::abs(range.low), std::abs(range.high));
  if (!(range.high - range.low > min)) return {range.low - 0.5, range.low + 0.5};
  const double more = kRoom * (range.high - range.low);
  return {range.low == 0 ? 0 : range.low - more, range.high == 0 ? 0 : range.high + more};
}

class Chart {
 public:
  Chart(Pen& pen, Font& font, const Plot& plot, int place)
      : pen_(pen), font_(font), plot_(plot), values_(rangeOf(plot.points)) {
    times_.high = plot.lastTime > 0 ? plot.lastTime : 1;
    if (!plot.points.empty()) times_.high = std::max(times_.high, plot.points.back().time);
    box_.left = pen.px(kMargin) + place * pen.px(kWidth + kGap);
    box_.bottom = pen.picture().height - pen.px(kMargin);
    box_.right = box_.left + pen.px(kWidth);
    box_.top = box_.bottom - pen.px(kHeight);
    inner_ = {box_.left + pen.px(kLeft), box_.top + pen.px(kTop), box_.right - pen.px(kRight),
              box_.bottom - pen.px(kBottom)};
  }

  void draw() {
    constexpr float kPaper = 0.62f, kAxis = 0.55f, kGrid = 0.14f;
    pen_.fill(box_, pen_.paper(), kPaper);
    const TextMask caption = font_.write(plot_.caption, pen_.scaled(kCaptionSize));
    pen_.stamp(caption, box_.left + pen_.px(kGap) / 2, box_.top + pen_.px(kTick));
    const int thin = std::max(1, pen_.px(1));
    for (const Tick& tick : roundTicks(values_.low, values_.high, kTicks)) {
      const int y = rowOf(tick.value);
      pen_.fill({inner_.left, y, inner_.right, y + thin}, pen_.ink(), kGrid);
      const TextMask label = font_.write(tick.label, pen_.scaled(kTextSize));
      pen_.stamp(label, inner_.left - pen_.px(kTick) - label.width, y - label.height / 2);
    }
    const std::vector<Tick> times = roundTicks(times_.low, times_.high, kTimeTicks);
    for (const Tick& tick : times) {
      const int x = columnOf(tick.value);
      pen_.fill({x, inner_.bottom, x + thin, inner_.bottom + pen_.px(kTick)}, pen_.ink(), kAxis);
      const bool last = &tick == &times.back();
      const TextMask label = font_.write(last ? tick.label + " s" : tick.label, pen_.scaled(kTextSize));
      const int left = std::min(x - label.width / 2, box_.right - pen_.px(kTick) - label.width);
      pen_.stamp(label, left, inner_.bottom + pen_.px(kTick));
    }
    pen_.fill({inner_.left, inner_.bottom, inner_.right, inner_.bottom + thin}, pen_.ink(), kAxis);
    pen_.fill({inner_.left, inner_.top, inner_.left + thin, inner_.bottom}, pen_.ink(), kAxis);
    drawCurve();
  }

 private:
  int columnOf(double time) const {
    return inner_.left + int(std::lround(times_.part(time) * (inner_.right - inner_.left)));
  }
  int rowOf(double value) const {
    return inner_.bottom - int(std::lround(values_.part(value) * (inner_.bottom - inner_.top)));
  }

  void drawCurve() {
    constexpr Vec3f kBlue{0.07f, 0.42f, 0.80f};
    std::vector<Vec2f> points;
    for (const PlotPoint& point : plot_.points) {
      if (!std::isfinite(point.value)) {
        pen_.curve(points, kCurve, kBlue);
        points.clear();
        continue;
      }
      points.push_back({float(inner_.left + times_.part(point.time) * (inner_.right - inner_.left)),
                        float(inner_.bottom - values_.part(point.value) * (inner_.bottom - inner_.top))});
    }
    pen_.curve(points, kCurve, kBlue);
    constexpr float kDot = 7;
    if (!points.empty()) pen_.curve({points.back()}, kDot, kBlue);
  }

  Pen& pen_;
  Font& font_;
  const Plot& plot_;
  Range values_, times_;
  Rectangle box_{}, inner_{};
};

}  // namespace

void drawPlot(Pen& pen, Font& font, const Plot& plot, int place) {
  Chart(pen, font, plot, place).draw();
}

}  // namespace weir::rendering
