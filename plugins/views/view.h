// What one picture shows: plain data that a renderer draws, on the host but for particles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "framework/base/vec.h"
#include "framework/graph/param_types.h"
#include "plugins/video/picture.h"
#include "plugins/views/color_map.h"
#include "plugins/views/environment_image.h"

namespace weir::rendering {

/// How a surface looks. Water is a closed surface that is clear inside.
enum class SurfaceLook { kMatt, kGlass, kMetal, kWater };

/// Where the camera is, what it looks at, and which direction is up in the picture. Metres.
struct CameraPose {
  Vec3f eye{2, 1.5f, 2};
  Vec3f target{};
  Vec3f up{0, 1, 0};
  float fovDegrees = 40;  ///< vertical field of view, in (0, 180)
};

/// A camera with this field of view that sees all of the box from `direction` (from the box to the camera),
/// with a small margin. An empty box counts as one of 1 m around the origin.
CameraPose poseSeeing(const Aabb& box, const Vec3f& direction, const Vec3f& up, float fovDegrees,
                      float aspectRatio);

/// A box with more room on all sides, m; an empty one stays empty.
inline Aabb widened(const Aabb& box, float margin) {
  const Vec3f around{margin, margin, margin};
  return {box.lo - around, box.hi + around};
}

/// A clear liquid: what its inside does to light, and how particles become its surface. Where it is, the
/// particles and the surfaces say that name it.
struct WaterView {
  Vec3f absorption{4.2f, 1.1f, 0.55f};  ///< of red, green and blue light, 1/m
  float scattering = 0.6f;              ///< 1/m; what is scattered has the colour below
  Color scattered{0.35f, 0.75f, 0.88f, 1};
  float refractiveIndex = 1.33f;  ///< at least 1
  float smoothing = 0.03f;        ///< m: how far apart the particles may be that are smoothed together
  float foamOpacity = 30;         ///< 1/m of foam in the line of sight

  friend bool operator==(const WaterView&, const WaterView&) = default;
};

/// Where a surface is: turned by `rotation`, then moved by `position`.
struct Placement {
  Quatf rotation;
  Vec3f position;  ///< m
};

/// Spheres of one radius. Particles at places that are not finite are left out.
struct ParticleView {
  std::span<const Vec3f> positions;
  std::span<const float> values;  ///< one per particle; empty: all have the fixed colour
  /// Whether these, and foam, are in memory of the device that draws (see Renderer::readsDevice).
  bool onDevice = false;
  float radius = 0.01f;  ///< m
  ColorMap map;
  float lowest = 0, highest = 1;  ///< values at the ends of the colour map
  Color fixed{0.16f, 0.45f, 0.85f, 1};

  // Instead of spheres with colours, a liquid:
  std::optional<std::size_t> water;  ///< index into View::waters
  std::span<const float> foam;       ///< one per particle, from 0 (clear) to 1 (white); empty: all are clear
  float volume = 0;                  ///< of one particle, m^3
  /// By how much a sphere stands out from the space that its particle fills, m. Without this, liquids would
  /// stand out from the walls that hold them.
  float inset() const { return std::max(0.0f, radius - 0.5f * std::cbrt(volume)); }
  /// The way through the middle of a sphere that holds the volume of its particle, m.
  float chord() const {
    const float sphere = 4 * std::numbers::pi_v<float> / 3 * radius * radius * radius;
    return 2 * radius * (volume > 0 ? volume / sphere : 1.0f);
  }

  std::string node = {};                   ///< whose they are
  std::span<const Vec3f> velocities = {};  ///< m/s, one per particle, on the host; empty: none are known
  bool white = false;                      ///< white water, which lets light through and casts no shadow
  /// m, one per particle, on the host, for those who draw spheres of several radii; empty: all have `radius`.
  std::span<const float> radii = {};
};

/// A mesh that was given to the renderer (see Renderer::addMesh).
using MeshId = std::uint32_t;

/// One appearance of a mesh: turned by `rotation`, then moved by `position`.
struct SurfaceView {
  MeshId mesh = 0;
  SurfaceLook look = SurfaceLook::kMatt;
  Color color{0.75f, 0.77f, 0.8f, 1};  ///< of glass: a tenth power of it tints each wall seen straight on
  Quatf rotation;
  Vec3f position;
  std::size_t water = 0;  ///< for kWater: index into View::waters

  std::string node = {};                           ///< whose it is
  std::span<const Vec3f> velocities = {};          ///< m/s, of each vertex; empty: none are known
  std::span<const float> foam = {};                ///< cover of each vertex (SurfaceFoam); empty: none
  float foamReach = 0;                             ///< m, over which that is a mean
  std::optional<Placement> before = std::nullopt;  ///< where it was one frame ago
};

/// Separate line segments, such as the edges of a tank.
struct LineView {
  std::span<const Vec3f> points;  ///< two per segment
  Color color{0.25f, 0.28f, 0.32f, 0.8f};
  float width = 1.5f;  ///< in pixels of a picture that is 720 pixels high
};

/// A level floor, seen from above only. It fades into the background towards its rim.
struct GroundView {
  bool visible = true;
  float height = 0;   ///< m along View::worldUp
  Vec3f center;       ///< its middle, before it is moved to the height
  float radius = 10;  ///< m
  Color color{0.91f, 0.915f, 0.92f, 1};
  float tiles = 0;  ///< side of its tiles, m; 0: it is plain
};

/// What surrounds the scene.
enum class EnvironmentLook {
  kStudio,  ///< the background of View; mirrors show a room with lamps
  kSky,     ///< a blue sky with clouds
  kImage    ///< EnvironmentView's picture
};

/// How light becomes colours.
enum class ToneCurve {
  kPlain,  ///< as it is, but for a soft shoulder where it is too bright
  kFilmic  ///< the contrast of film, with paler highlights
};

struct LightingView {
  Vec3f towardsSun{0.45f, 1.0f, 0.35f};  ///< any length but zero
  bool shadows = true;
  bool occlusion = true;  ///< darkens what is hemmed in (screen-space ambient occlusion)
  float occlusionRadius =
      0;  ///< m; 0: six of the largest particle's radii, or a part of the scene's size without particles
  ToneCurve tone = ToneCurve::kPlain;
  float exposure = 1;     ///< factor of all light
  float sunStrength = 1;  ///< factor of the sun's light
  bool unlit = false;     ///< every surface has its plain colour, so that colours can be read exactly
};

struct View {
  std::int64_t frame = 0;          ///< number of the run's frame
  double time = 0;                 ///< s
  int width = 1280, height = 720;  ///< pixels
  int samplesPerAxis = 2;          ///< 1 (jagged) to 4: each pixel averages the square of this number
  CameraPose camera;
  Vec3f worldUp{0, 1, 0};  ///< against gravity
  std::vector<ParticleView> particles;
  std::vector<SurfaceView> surfaces;
  std::vector<WaterView> waters;
  std::vector<LineView> lines;
  GroundView ground;
  LightingView lighting;
  EnvironmentLook environment = EnvironmentLook::kStudio;
  std::shared_ptr<const EnvironmentImage> environmentImage;  ///< for kImage
  bool environmentBehind = true;                             ///< of kImage: whether it is the background
  /// Nothing is behind the scene, and the ground shows its shadows alone: the picture has opacities.
  bool transparent = false;
  Color backgroundTop{0.78f, 0.84f, 0.9f, 1};
  Color backgroundBottom{0.95f, 0.96f, 0.97f, 1};
};

}  // namespace weir::rendering
