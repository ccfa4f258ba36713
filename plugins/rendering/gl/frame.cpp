#include "plugins/rendering/gl/frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "plugins/rendering/gl/environment.h"

namespace weir::rendering::gl {

Vec3f linear(const Color& color) {
  const auto component = [](float s) {
    return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
  };
  return {component(color.r), component(color.g), component(color.b)};
}

Aabb seenBox(const View& view, const Aabb& casters) {
  Aabb seen = casters;
  for (const LineView& lines : view.lines)
    for (const Vec3f& point : lines.points)
      if (isFinite(point)) seen.extend(point);
  if (view.ground.visible) {
    const Vec3f up = normalized(view.worldUp);
    const Vec3f middle = view.ground.center + up * (view.ground.height - dot(view.ground.center, up));
    const Vec3f around{view.ground.radius, view.ground.radius, view.ground.radius};
    seen.extend(Aabb{middle - around, middle + around});
  }
  return seen;
}

float occlusionRadius(const View& view, const Aabb& casters) {
  if (view.lighting.occlusionRadius > 0) return view.lighting.occlusionRadius;
  float largest = 0;
  for (const ParticleView& particles : view.particles)
    if (!particles.positions.empty()) largest = std::max(largest, particles.radius);
  if (largest > 0) return 6 * largest;
  constexpr float kPartOfScene = 0.04f;
  return casters.empty() ? 1.0f : kPartOfScene * length(casters.size());
}

void setCameraUniforms(const Program& program, const Camera& camera, int width, int height) {
  program.set("uProjection", camera.projectionTerms());
  program.set("uTangent", camera.tangent);
  program.set("uPixel", Vec2f{2.0f / float(width), 2.0f / float(height)});
}

void setGridUniform(const Program& program, int width, int height) {
  constexpr float kSteps = 128;
  program.set("uGrid", Vec2f{kSteps * float(width), kSteps * float(height)});
}

void setBehindUniforms(const Program& program, const Frame& frame, const Texture& before, int unit) {
  program.setTexture("uBefore", unit, before);
  program.set("uSampleSize", Vec2f{1 / float(frame.width), 1 / float(frame.height)});
}

bool hasSurroundings(const View& view) {
  return view.environment != EnvironmentLook::kStudio;
}

bool isOutside(const View& view) {
  const bool shown = view.environment != EnvironmentLook::kImage || view.environmentBehind;
  return hasSurroundings(view) && shown && !view.transparent;
}

/// The light of an image of the surroundings, as quadratic forms in camera space.
static void setImageLight(const Program& program, const Frame& frame) {
  using Form = Eigen::Matrix<float, 4, 4, Eigen::RowMajor>;
  Eigen::Matrix4f turn = Eigen::Matrix4f::Identity();
  turn.topLeftCorner<3, 3>() = upright(frame.view) * frame.camera.rotation().transpose();
  const char* const names[] = {"uSkyRed", "uSkyGreen", "uSkyBlue"};
  for (int c = 0; c < 3; ++c) {
    const Eigen::Map<const Form> form(
        frame.view.environmentImage->ambient[static_cast<std::size_t>(c)].data());
    program.setMatrix4(names[c], (turn.transpose() * form * turn).eval().data());
  }
}

void setLightUniforms(const Program& program, const Frame& frame) {
  const View& view = frame.view;
  program.set("uSun", frame.camera.direction(normalized(view.lighting.towardsSun)));
  program.set("uUp", frame.camera.direction(normalized(view.worldUp)));
  const bool outside = hasSurroundings(view), image = view.environment == EnvironmentLook::kImage;
  program.set("uImageLight", int(image));
  if (image) setImageLight(program, frame);
  // The sky lights in a paler colour than it has, or everything would look blue.
  constexpr Vec3f kWhite{1, 1, 1}, kSkyBlue{0.72f, 0.86f, 1};
  const Vec3f sky = outside ? kSkyBlue : 0.5f * (kWhite + linear(view.backgroundTop));
  program.set("uSkyColor", image ? view.environmentImage->mean : sky);
  program.set("uSkyStrength", outside ? 0.36f : 0.56f);
  const Vec3f sun = outside ? Vec3f{1.18f, 1.06f, 0.88f} : Vec3f{0.74f, 0.71f, 0.66f};
  program.set("uSunColor", view.lighting.sunStrength * sun);
  program.set("uGroundColor", linear(view.ground.visible ? view.ground.color : view.backgroundBottom));
}

Targets::Targets(const Functions& gl, int width, int height, int samplesPerAxis)
    : pictureWidth(width), pictureHeight(height), samples(samplesPerAxis) {
  const int fineWidth = width * samples, fineHeight = height * samples;
  albedo = makeTexture(gl, fineWidth, fineHeight, kSrgb8, GL_NEAREST);
  normal = makeTexture(gl, fineWidth, fineHeight, kNormal, GL_NEAREST);
  depth = makeTexture(gl, fineWidth, fineHeight, kDepth32F, GL_NEAREST);
  geometry = makeFramebuffer(gl, {&albedo, &normal}, &depth);
  for (int i = 0; i < 2; ++i) {
    occlusion[i] = makeTexture(gl, width, height, kGrey16, GL_LINEAR);
    occlusionTargets[i] = makeFramebuffer(gl, {&occlusion[i]}, nullptr);
  }
  light = makeTexture(gl, fineWidth, fineHeight, kColor16F, GL_NEAREST);
  lighting = makeFramebuffer(gl, {&light}, nullptr);
  lightWithDepth = makeFramebuffer(gl, {&light}, &depth);
  picture = makeTexture(gl, width, height, kColor8, GL_NEAREST);
  pictureTarget = makeFramebuffer(gl, {&picture}, nullptr);
}

}  // namespace weir::rendering::gl
