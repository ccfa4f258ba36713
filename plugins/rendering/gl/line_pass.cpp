#include "plugins/rendering/gl/line_pass.h"

#include <cmath>
#include <optional>

#include "framework/base/check.h"

namespace weir::rendering::gl {
namespace {

using Segment = std::pair<Vec3f, Vec3f>;

/// The part of a segment in camera space that is in front of the near plane.
std::optional<Segment> inFront(Vec3f a, Vec3f b, float near) {
  const float overA = -a.z - near, overB = -b.z - near;
  if (!(overA > 0) && !(overB > 0)) return std::nullopt;
  const auto cut = [&] { return a + (b - a) * (overA / (overA - overB)); };
  if (!(overA > 0)) return Segment{cut(), b};
  if (!(overB > 0)) return Segment{a, cut()};
  return Segment{a, b};
}

}  // namespace

std::vector<Vec4f> lineCorners(const Frame& frame, const LineView& lines) {
  const Camera& camera = frame.camera;
  const std::span<const Vec3f> points = lines.points;
  // Of 720 pixels' height, in clip space after division by w, which is 2 high.
  const float high = lines.width / 720.0f, aspect = float(frame.width) / float(frame.height);
  const Vec2f halfWidth{high / aspect, high};
  WEIR_CHECK(points.size() % 2 == 0u);
  const Vec4f terms = camera.projectionTerms();
  // A little nearer than they are, so that lines on a surface are seen.
  constexpr float kNearer = 1 - 2e-3f;
  const auto toClip = [&](const Vec3f& p) {
    const Vec3f q = p * kNearer;
    return Vec4f{terms.x * q.x, terms.y * q.y, terms.z * q.z + terms.w, -q.z};
  };
  std::vector<Vec4f> corners;
  corners.reserve(3 * points.size());
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    if (!isFinite(points[i]) || !isFinite(points[i + 1])) continue;
    const auto segment = inFront(camera.point(points[i]), camera.point(points[i + 1]), camera.near * 1.01f);
    if (!segment) continue;
    const Vec4f a = toClip(segment->first), b = toClip(segment->second);
    // Across the line in the picture, in units of its half width.
    float x = (b.x / b.w - a.x / a.w) / halfWidth.x, y = (b.y / b.w - a.y / a.w) / halfWidth.y;
    const float size = std::hypot(x, y);
    if (!(size > 0)) continue;
    x /= size, y /= size;
    const auto corner = [&](const Vec4f& end, float along, float across) {
      return Vec4f{end.x + (along * x - across * y) * halfWidth.x * end.w,
                   end.y + (along * y + across * x) * halfWidth.y * end.w, end.z, end.w};
    };
    const Vec4f quad[4] = {corner(a, -1, -1), corner(a, -1, 1), corner(b, 1, -1), corner(b, 1, 1)};
    for (const int k : {0, 1, 2, 2, 1, 3}) corners.push_back(quad[k]);
  }
  return corners;
}

LinePass::LinePass(const Functions& gl)
    : gl_(gl), program_(gl, "line.vert", "line.frag"), array_(makeVertexArray(gl)), buffer_(makeBuffer(gl)) {
  gl.bindVertexArray(array_.name());
  gl.bindBuffer(GL_ARRAY_BUFFER, buffer_.name());
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(Vec4f), nullptr);
}

void LinePass::draw(const Frame& frame, const Targets& targets, const Texture& before) const {
  targets.lightWithDepth.bind();
  setState(gl_, {.depthTest = GL_LEQUAL,
                 .writesDepth = false,
                 .source = GL_ONE,
                 .destination = GL_ONE_MINUS_SRC_ALPHA});
  program_.use();
  setBehindUniforms(program_, frame, before);
  gl_.bindVertexArray(array_.name());
  for (const LineView& lines : frame.view.lines) {
    const std::vector<Vec4f> corners = lineCorners(frame, lines);
    if (corners.empty()) continue;
    upload(buffer_, GL_ARRAY_BUFFER, std::as_bytes(std::span(corners)), GL_STREAM_DRAW);
    const Vec3f color = linear(lines.color);
    program_.set("uColor", Vec4f{color.x, color.y, color.z, lines.color.a});
    gl_.drawArrays(GL_TRIANGLES, 0, GLsizei(corners.size()));
  }
}

}  // namespace weir::rendering::gl
