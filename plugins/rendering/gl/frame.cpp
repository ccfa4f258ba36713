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

Color inBytes(const Color& color) {
  const auto byte = [](float x) { return std::round(255 * std::clamp(x, 0.0f, 1.0f)) / 255; };
  return {byte(color.r), byte(color.g), byte(color.b), 1};
}

Vec3f groundMiddle(const View& view) {
  const Vec3f up = normalized(view.worldUp);
  return view.ground.center + up * (view.ground.height - dot(view.ground.center, up));
}

/// The box around all that is seen: what casts shadows, lines and the ground.
static Aabb seenBox(const View& view, const Aabb& casters) {
  Aabb seen = casters;
  for (const LineView& lines : view.lines)
    for (const Vec3f& point : lines.points)
      if (isFinite(point)) seen.extend(point);
  if (view.ground.visible) {
    const Vec3f middle = groundMiddle(view);
    seen.extend(widened({middle, middle}, view.ground.radius));
  }
  return seen;
}

Frame makeFrame(const View& view, int samples, const Aabb& casters) {
  const float aspect = float(view.width) / float(view.height);
  Frame frame{.view = view,
              .samples = samples,
              .width = view.width * samples,
              .height = view.height * samples,
              .camera = makeCamera(view.camera, aspect, seenBox(view, casters))};
  for (const ParticleView& particles : view.particles)
    if (!particles.positions.empty()) frame.largestRadius = std::max(frame.largestRadius, particles.radius);
  frame.hasShadows = view.lighting.shadows && !view.lighting.unlit && !casters.empty();
  if (frame.hasShadows) frame.sun = makeSunView(view.lighting.towardsSun, casters, kShadowResolution);
  return frame;
}

/// How far ambient occlusion reaches, m.
static float occlusionRadius(const Frame& frame, const Aabb& casters) {
  if (frame.view.lighting.occlusionRadius > 0) return frame.view.lighting.occlusionRadius;
  if (frame.largestRadius > 0) return 6 * frame.largestRadius;
  constexpr float kPartOfScene = 0.04f;
  return casters.empty() ? 1.0f : kPartOfScene * length(casters.size());
}

ShadedOcclusion occlusionOf(const Frame& frame, const Aabb& casters) {
  constexpr float kLargestPart = 0.12f;
  const auto height = float(frame.height);
  return {.radius = occlusionRadius(frame, casters),
          .radiusInView = 0.5f * height / frame.camera.tangent.y,
          .largest = kLargestPart * height};
}

ShadedLight lightOf(const Frame& frame) {
  const View& view = frame.view;
  const bool outside = hasSurroundings(view), image = view.environment == EnvironmentLook::kImage;
  // The sky lights in a paler colour than it has, or everything would look blue.
  constexpr Vec3f kWhite{1, 1, 1}, kSkyBlue{0.72f, 0.86f, 1};
  const Vec3f sky = outside ? kSkyBlue : 0.5f * (kWhite + linear(view.backgroundTop));
  const Vec3f sun = outside ? Vec3f{1.18f, 1.06f, 0.88f} : Vec3f{0.74f, 0.71f, 0.66f};
  const float skyStrength = outside ? 0.36f : 0.56f;
  ShadedLight light{.sun = frame.camera.direction(normalized(view.lighting.towardsSun)),
                    .up = frame.camera.direction(normalized(view.worldUp)),
                    .sunColor = view.lighting.sunStrength * sun,
                    .sky = image ? view.environmentImage->mean : sky,
                    .ground = linear(view.ground.visible ? view.ground.color : view.backgroundBottom),
                    .background = {linear(view.backgroundBottom), linear(view.backgroundTop)},
                    .unlit = view.lighting.unlit};
  light.skyAbove = skyStrength * light.sky;
  light.skyBelow = skyStrength * 0.62f * light.ground;
  if (!frame.hasShadows) return light;
  constexpr float kSoftTexels = 5, kTexels = kShadowResolution;
  light.shadowTexel = 2 * frame.sun.halfSize / kTexels;
  light.softness = kSoftTexels / kTexels;
  return light;
}

Eigen::Matrix4f toShadowMap(const Frame& frame) {
  return frame.sun.toTexture() * frame.camera.view.inverse();
}

Eigen::Matrix3f slopeToShadowMap(const Frame& frame) {
  const SunView& sun = frame.sun;
  Eigen::Matrix3f turn = sun.view.topLeftCorner<3, 3>() * frame.camera.rotation().transpose();
  turn.topRows<2>() *= 2 * sun.halfSize / (sun.zNearest - sun.zFarthest);
  return turn;
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

void setBehindUniforms(const Program& program, const Frame& frame, const Texture& before) {
  program.setTexture("uBefore", before);
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
  turn.topLeftCorner<3, 3>() = toSurroundings(frame);
  const char* const names[] = {"uSkyRed", "uSkyGreen", "uSkyBlue"};
  for (int c = 0; c < 3; ++c) {
    const Eigen::Map<const Form> form(
        frame.view.environmentImage->ambient[static_cast<std::size_t>(c)].data());
    program.setMatrix4(names[c], (turn.transpose() * form * turn).eval().data());
  }
}

void setLightUniforms(const Program& program, const Frame& frame) {
  const ShadedLight light = lightOf(frame);
  program.set("uSun", light.sun);
  program.set("uUp", light.up);
  program.set("uSunColor", light.sunColor);
  program.set("uSkyColor", light.sky);
  program.set("uGroundColor", light.ground);
  program.set("uSkyAbove", light.skyAbove);
  program.set("uSkyBelow", light.skyBelow);
  const bool image = frame.view.environment == EnvironmentLook::kImage;
  program.set("uImageLight", int(image));
  if (image) setImageLight(program, frame);
}

Targets::Targets(const Functions& gl, int width, int height, int samplesPerAxis)
    : pictureWidth(width),
      pictureHeight(height),
      samples(samplesPerAxis),
      albedo(gl, width * samples, height * samples, kSrgb8, GL_NEAREST),
      normal(gl, width * samples, height * samples, kNormal, GL_NEAREST),
      depth(gl, width * samples, height * samples, kDepth32F, GL_NEAREST),
      geometry(gl, {&albedo, &normal}, &depth),
      light(gl, width * samples, height * samples, kColor16F, GL_NEAREST),
      lightWithDepth(gl, {&light.texture}, &depth),
      picture(gl, width, height, kColor8, GL_NEAREST) {
  for (Canvas& canvas : occlusion) canvas = Canvas(gl, width, height, kGrey16, GL_LINEAR);
}

}  // namespace weir::rendering::gl
