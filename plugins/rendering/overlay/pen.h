// What draws on a finished picture: rectangles, texts and curves, with sizes that follow the picture's
// height.
#pragma once

#include <cmath>
#include <vector>

#include "framework/base/vec.h"
#include "plugins/rendering/overlay/font.h"
#include "plugins/video/picture.h"

namespace weir::rendering {

struct Rectangle {
  int left, top, right, bottom;  ///< pixels; the last two are the first ones beyond
};

/// Lengths are in pixels of a picture that is 720 pixels high, places in those of this picture. What is
/// outside of the picture is passed over.
class Pen {
 public:
  /// Light ink for dark backgrounds.
  Pen(Picture& picture, bool light);

  int px(float length) const { return int(std::lround(length * scale_)); }
  float scaled(float size) const { return size * scale_; }
  const Picture& picture() const { return picture_; }
  const Vec3f& ink() const { return ink_; }
  /// The colour that is farthest from the ink.
  const Vec3f& paper() const { return paper_; }

  void fill(const Rectangle& area, const Vec3f& color, float opacity);
  /// With a soft edge in the opposite brightness, so that it can be read on everything.
  void stamp(const TextMask& mask, int left, int top);
  /// Straight lines from point to point, with round corners.
  void curve(const std::vector<Vec2f>& points, float width, const Vec3f& color);

 private:
  int haloReach() const;
  void blend(int x, int y, const Vec3f& color, float opacity);

  Picture& picture_;
  float scale_;
  Vec3f ink_, paper_;
};

}  // namespace weir::rendering
