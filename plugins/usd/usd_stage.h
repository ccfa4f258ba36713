// The root layer of a run in USD: a small text that names the prims, their materials and where the values of
// each frame are, in layers of their own (value clips). Camera and poses, which are few numbers, stand in it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/vec.h"
#include "framework/geometry/triangle_mesh.h"
#include "plugins/views/view.h"

namespace weir::rendering {

/// The attribute of the colours that programs show, and the light that sRGB colours stand for, as it has
/// them.
inline constexpr const char* kDisplayColor = "primvars:displayColor";
Vec3f lightOf(const Vec3f& srgb);

/// An attribute whose values the frames hold.
struct UsdAttribute {
  std::string type, name;  ///< "point3f[]", "points"
  bool isVertex = false;   ///< a primvar, or normals: one value for each point
};

/// What has points in USD: the particles of a node (Points), or a surface (Mesh).
struct UsdThing {
  std::string prim;  ///< its name below /World
  bool isMesh = false;
  bool isAnimated = true;  ///< its values are in the frames; else in `mesh`
  float width = 0;         ///< of points, m
  Color color;             ///< unless the frames have kDisplayColor
  std::string material;    ///< below /World/Materials; "" for none
  std::vector<UsdAttribute> attributes;

  bool has(std::string_view attribute) const;
  const TriangleMesh* mesh = nullptr;  ///< of one that keeps its shape
};

struct UsdMaterial {
  SurfaceLook look = SurfaceLook::kMatt;
  Color color;
  std::optional<WaterView> water;
};

/// Of a frame, what the root layer says of it.
struct UsdMoment {
  std::int64_t frame = 0;
  CameraPose camera;
  std::vector<Placement> places;  ///< of the things that keep their shape, in their order
};

struct UsdStage {
  double frameRate = 0;  ///< 1/s
  double aspect = 1;     ///< width by height of the picture
  float aperture = 0;    ///< diameter of the lens, m
  std::optional<float> focus;
  std::string frames;  ///< the folder of the frames, beside the root layer
  std::vector<UsdThing> things;
  std::map<std::string, UsdMaterial> materials;  ///< by name
  std::vector<UsdMoment> moments;                ///< of all frames so far
};

/// A name that a prim may have: letters, digits and _, the first no digit. Different from those in `taken`,
/// to which it is added.
std::string primNameOf(const std::string& name, std::vector<std::string>& taken);

/// "frame.00012.usdc", as the root layer's template finds them.
std::string usdFrameName(std::int64_t frame);

/// The root layer, and the manifest of the clips, which says what attributes the frames hold.
std::string rootLayerOf(const UsdStage& stage);
std::string manifestOf(const UsdStage& stage);

}  // namespace weir::rendering
