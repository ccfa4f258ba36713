// What the passes of one picture share.
#pragma once

#include "plugins/rendering/gl/camera.h"
#include "plugins/rendering/gl/resources.h"
#include "plugins/rendering/shading/light.h"
#include "plugins/views/view.h"

namespace weir::rendering::gl {

/// sRGB components, as colours are given, in linear light.
Vec3f linear(const Color& color);
/// sRGB components as bytes hold them: drivers round halves, such as 0.5 * 255, as they like.
Color inBytes(const Color& color);
/// The middle of the ground, in the world.
Vec3f groundMiddle(const View& view);

/// Whether mirrors show surroundings that are more than a studio.
bool hasSurroundings(const View& view);
/// Whether those are the background.
bool isOutside(const View& view);

struct Frame {
  const View& view;
  int samples = 1;            ///< per axis and pixel
  int width = 0, height = 0;  ///< in samples
  Camera camera;
  bool hasShadows = false;
  SunView sun;              ///< only with shadows
  float largestRadius = 0;  ///< of all particles, m; 0 without any
};

constexpr int kMaxSamples = 4;  ///< per axis and pixel

/// `casters` is the box around all that casts shadows. Throws what makeCamera() does.
Frame makeFrame(const View& view, int samples, const Aabb& casters);
ShadedLight lightOf(const Frame& frame);
ShadedOcclusion occlusionOf(const Frame& frame, const Aabb& casters);
/// From camera space to the shadow map.
Eigen::Matrix4f toShadowMap(const Frame& frame);
/// Turns a normal from camera space to (x, y, z) such that depths in the shadow map of a plane with that
/// normal grow by (x, y) / z along the map; z is the cosine of its angle to the sun.
Eigen::Matrix3f slopeToShadowMap(const Frame& frame);

/// The uniforms of camera.glsl, for a picture of this many pixels.
void setCameraUniforms(const Program& program, const Camera& camera, int width, int height);
/// The uniform of grid.glsl, for a window of this many samples.
void setGridUniform(const Program& program, int width, int height);
/// The uniforms of behind.glsl.
void setBehindUniforms(const Program& program, const Frame& frame, const Texture& before);
/// The uniforms of light.glsl.
void setLightUniforms(const Program& program, const Frame& frame);

/// The textures that a picture of one size needs.
struct Targets {
  Targets(const Functions& gl, int width, int height, int samplesPerAxis);

  int pictureWidth, pictureHeight, samples;
  Texture albedo, normal, depth;  ///< of the nearest surface; albedo is sRGB, its alpha the material
  Framebuffer geometry;
  Canvas occlusion[2];  ///< one value per pixel; 1 is open
  Canvas light;         ///< linear light
  Framebuffer lightWithDepth;
  Canvas picture;  ///< the end result, upper row first
};

}  // namespace weir::rendering::gl
