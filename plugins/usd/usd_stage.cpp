#include "plugins/usd/usd_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

namespace weir::rendering {

namespace {

using Text = fmt::memory_buffer;

template <class... Arguments>
void put(Text& to, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(to), format, std::forward<Arguments>(arguments)...);
}

/// Light of a colour that is given as sRGB.
float linear(float srgb) {
  return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

std::string textOf(const Vec3f& v) {
  return fmt::format("({}, {}, {})", v.x, v.y, v.z);
}

std::string textOf(const Color& c) {
  return textOf(lightOf({c.r, c.g, c.b}));
}

/// Rows of a matrix that is multiplied with rows.
std::string matrixOf(const Vec3f& x, const Vec3f& y, const Vec3f& z, const Vec3f& place) {
  const auto row = [](const Vec3f& v, int last) {
    return fmt::format("({}, {}, {}, {})", v.x, v.y, v.z, last);
  };
  return fmt::format("( {}, {}, {}, {} )", row(x, 0), row(y, 0), row(z, 0), row(place, 1));
}

std::string matrixOf(const Placement& place) {
  const auto axis = [&](const Vec3f& v) { return rotate(place.rotation, v); };
  return matrixOf(axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1}), place.position);
}

/// Of a camera, which looks along its -z.
std::string matrixOf(const CameraPose& camera) {
  const Vec3f back = normalized(camera.eye - camera.target);
  Vec3f right = cross(camera.up, back);
  if (length(right) < 1e-6f) right = cross(std::abs(back.y) < 0.9f ? Vec3f{0, 1, 0} : Vec3f{1, 0, 0}, back);
  right = normalized(right);
  return matrixOf(right, cross(back, right), back, camera.eye);
}

void putHead(Text& to, const UsdStage& stage) {
  const std::int64_t first = stage.moments.empty() ? 0 : stage.moments.front().frame;
  const std::int64_t last = stage.moments.empty() ? 0 : stage.moments.back().frame;
  put(to,
      "#usda 1.0\n(\n    defaultPrim = \"World\"\n    doc = \"A run of Weir, lengths in metres\"\n"
      "    endTimeCode = {}\n    framesPerSecond = {}\n    metersPerUnit = 1\n    startTimeCode = {}\n"
      "    timeCodesPerSecond = {}\n    upAxis = \"Y\"\n)\n\n",
      last, stage.frameRate, first, stage.frameRate);
  put(to,
      "def Xform \"World\" (\n    clips = {{\n        dictionary default = {{\n"
      "            asset manifestAssetPath = @./{0}/manifest.usda@\n            string primPath = "
      "\"/World\"\n"
      "            string templateAssetPath = \"./{0}/frame.#####.usdc\"\n"
      "            double templateEndTime = {1}\n            double templateStartTime = {2}\n"
      "            double templateStride = 1\n        }}\n    }}\n)\n{{\n",
      stage.frames, last, first);
}

template <class F>
void putSamples(Text& to, std::string_view attribute, const UsdStage& stage, const F& value) {
  put(to, "        {}.timeSamples = {{\n", attribute);
  for (const UsdMoment& moment : stage.moments) put(to, "            {}: {},\n", moment.frame, value(moment));
  put(to, "        }}\n");
}

/// Lengths of lenses are in tenths of the unit of length, here decimetres.
void putCamera(Text& to, const UsdStage& stage) {
  constexpr double kHeight = 0.24;  // of the sensor, dm
  const auto focal = [&](const UsdMoment& moment) {
    return kHeight / 2 / std::tan(double{moment.camera.fovDegrees} * std::numbers::pi / 360);
  };
  put(to, "    def Camera \"camera\"\n    {{\n        float2 clippingRange = (0.01, 100000)\n");
  put(to, "        float horizontalAperture = {}\n        float verticalAperture = {}\n",
      kHeight * stage.aspect, kHeight);
  putSamples(to, "float focalLength", stage, focal);
  putSamples(to, "float focusDistance", stage, [&](const UsdMoment& moment) {
    return stage.focus.value_or(length(moment.camera.target - moment.camera.eye));
  });
  if (stage.aperture > 0)
    putSamples(to, "float fStop", stage,
               [&](const UsdMoment& moment) { return focal(moment) / 10 / double{stage.aperture}; });
  putSamples(to, "matrix4d xformOp:transform", stage,
             [](const UsdMoment& moment) { return matrixOf(moment.camera); });
  put(to, "        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }}\n\n");
}

void putAttributes(Text& to, const UsdThing& thing) {
  for (const UsdAttribute& attribute : thing.attributes) {
    put(to, "        {} {}", attribute.type, attribute.name);
    if (attribute.isVertex) put(to, " (\n            interpolation = \"vertex\"\n        )");
    put(to, "\n");
  }
}

template <class T, class F>
void putList(Text& to, std::string_view attribute, const T& values, const F& textOfOne) {
  put(to, "        {} = [", attribute);
  for (std::size_t i = 0; i < values.size(); ++i) put(to, "{}{}", i > 0 ? ", " : "", textOfOne(values[i]));
  put(to, "]\n");
}

void putMesh(Text& to, const TriangleMesh& mesh) {
  Aabb box;
  for (const Vec3f& vertex : mesh.vertices) box.extend(vertex);
  put(to, "        float3[] extent = [{}, {}]\n", textOf(box.lo), textOf(box.hi));
  putList(to, "int[] faceVertexCounts", mesh.triangles, [](const Vec3i&) { return "3"; });
  putList(to, "int[] faceVertexIndices", mesh.triangles,
          [](const Vec3i& t) { return fmt::format("{}, {}, {}", t.x, t.y, t.z); });
  putList(to, "point3f[] points", mesh.vertices, [](const Vec3f& v) { return textOf(v); });
}

/// `still`: which of the things that keep their shape it is.
void putThing(Text& to, const UsdThing& thing, const UsdStage& stage, std::size_t still) {
  put(to, "    def {} \"{}\"", thing.isMesh ? "Mesh" : "Points", thing.prim);
  if (!thing.material.empty()) put(to, " (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )");
  put(to, "\n    {{\n");
  if (thing.isMesh) put(to, "        uniform token subdivisionScheme = \"none\"\n");
  if (!thing.has(kDisplayColor)) put(to, "        color3f[] {} = [{}]\n", kDisplayColor, textOf(thing.color));
  if (!thing.material.empty())
    put(to, "        rel material:binding = </World/Materials/{}>\n", thing.material);
  if (!thing.isMesh)
    put(to, "        float[] widths = [{}] (\n            interpolation = \"constant\"\n        )\n",
        thing.width);
  putAttributes(to, thing);
  if (!thing.isAnimated) {
    putMesh(to, *thing.mesh);
    putSamples(to, "matrix4d xformOp:transform", stage,
               [&](const UsdMoment& moment) { return matrixOf(moment.places.at(still)); });
    put(to, "        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n");
  }
  put(to, "    }}\n\n");
}

/// A clear liquid has the colour of what half a metre of it lets through.
Color colorOf(const UsdMaterial& material) {
  if (!material.water) return material.color;
  constexpr float kDepth = 0.5f, kGamma = 1 / 2.2f;
  const Vec3f& a = material.water->absorption;
  const auto through = [&](float absorption) { return std::pow(std::exp(-kDepth * absorption), kGamma); };
  return {through(a.x), through(a.y), through(a.z), 1};
}

void putMaterial(Text& to, const std::string& name, const UsdMaterial& material) {
  const bool clear = material.look == SurfaceLook::kGlass || material.look == SurfaceLook::kWater;
  const bool metal = material.look == SurfaceLook::kMetal;
  const float index = material.water ? material.water->refractiveIndex : 1.5f;
  put(to,
      "        def Material \"{0}\"\n        {{\n            token outputs:surface.connect = "
      "</World/Materials/{0}/shader.outputs:surface>\n\n            def Shader \"shader\"\n            {{\n"
      "                uniform token info:id = \"UsdPreviewSurface\"\n"
      "                color3f inputs:diffuseColor = {1}\n                float inputs:ior = {2}\n"
      "                float inputs:metallic = {3}\n                float inputs:opacity = {4}\n"
      "                float inputs:roughness = {5}\n                token outputs:surface\n"
      "            }}\n        }}\n",
      name, textOf(colorOf(material)), index, metal ? 1 : 0, clear ? 0.15 : 1.0,
      clear ? 0.02 : (metal ? 0.22 : 0.7));
}

}  // namespace

Vec3f lightOf(const Vec3f& srgb) {
  return {linear(srgb.x), linear(srgb.y), linear(srgb.z)};
}

bool UsdThing::has(std::string_view attribute) const {
  return std::any_of(attributes.begin(), attributes.end(),
                     [&](const UsdAttribute& one) { return one.name == attribute; });
}

std::string primNameOf(const std::string& name, std::vector<std::string>& taken) {
  std::string prim;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    prim += plain ? c : '_';
  }
  if (prim.empty() || (prim.front() >= '0' && prim.front() <= '9')) prim.insert(0, "_");
  const auto isTaken = [&](const std::string& text) {
    return std::find(taken.begin(), taken.end(), text) != taken.end();
  };
  std::string free = prim;
  for (int i = 2; isTaken(free); ++i) free = fmt::format("{}_{}", prim, i);
  taken.push_back(free);
  return free;
}

std::string usdFrameName(std::int64_t frame) {
  return fmt::format("frame.{:05}.usdc", frame);
}

std::string rootLayerOf(const UsdStage& stage) {
  Text text;
  putHead(text, stage);
  putCamera(text, stage);
  std::size_t still = 0;
  for (const UsdThing& thing : stage.things) {
    putThing(text, thing, stage, still);
    if (!thing.isAnimated) ++still;
  }
  put(text, "    def Scope \"Materials\"\n    {{\n");
  for (const auto& [name, material] : stage.materials) putMaterial(text, name, material);
  put(text, "    }}\n}}\n");
  return fmt::to_string(text);
}

std::string manifestOf(const UsdStage& stage) {
  Text text;
  put(text, "#usda 1.0\n\nover \"World\"\n{{\n");
  for (const UsdThing& thing : stage.things) {
    if (!thing.isAnimated) continue;
    put(text, "    over \"{}\"\n    {{\n", thing.prim);
    for (const UsdAttribute& attribute : thing.attributes)
      put(text, "        {} {}\n", attribute.type, attribute.name);
    put(text, "    }}\n");
  }
  put(text, "}}\n");
  return fmt::to_string(text);
}

}  // namespace weir::rendering
