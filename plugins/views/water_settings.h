// The look of a liquid in the "render" section of a scene file: of a fluid's particles, or of a closed mesh.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "framework/graph/configurable.h"
#include "plugins/views/view.h"

namespace weir {

namespace rendering {
/// How the particles of a fluid look.
enum class FluidLook { kSpheres, kWater, kWhite };
}  // namespace rendering

template <>
struct EnumNames<rendering::FluidLook> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"spheres", "A sphere for each particle, coloured by a quantity."},
      EnumName{"water", "A clear liquid with a smooth surface, which bends and absorbs light."},
      EnumName{"white", "A white sphere for each particle; what a WhiteWater has where nothing is said."}};
};

namespace rendering {

/// Where a fluid turns white.
class FoamSettings final : public Configurable {
 public:
  Param<std::string> by{
      *this,
      "by",
      "none",
      {.doc = "What whitens the particles: speed, or any attribute such as density; \"none\" for no "
              "foam."}};
  Param<Vec2f> range{
      *this,
      "range",
      {2, 4},
      {.doc =
           "Value up to which a particle is clear, and that from which on it is white. The second may be the "
           "lower one, as for density: spray is white."}};
  Param<float> opacity{*this,
                       "opacity",
                       60,
                       {.unit = "1/m",
                        .min = 0,
                        .softMax = 500,
                        .doc = "How much a metre of white particles covers: the part "
                               "exp(-opacity) shines through."}};

  bool shown() const { return *by != "none"; }
  void validate() const override;
};

/// What the inside of a liquid does to light.
class WaterSettings final : public Configurable {
 public:
  Param<Vec3f> absorption{
      *this,
      "absorption",
      WaterView{}.absorption,
      {.unit = "1/m",
       .min = 0,
       .doc = "How much red, green and blue light a metre of it absorbs: the part exp(-absorption) comes "
              "through. Deeper than that of real water, as tanks are smaller than lakes."}};
  Param<float> scattering{*this,
                          "scattering",
                          WaterView{}.scattering,
                          {.unit = "1/m",
                           .min = 0,
                           .softMax = 20,
                           .doc = "How turbid it is: light that a metre of it scatters."}};
  Param<Color> scattered{*this, "scattered", WaterView{}.scattered, {.doc = "Colour of what is scattered."}};
  Param<float> refractiveIndex{*this,
                               "refractive_index",
                               WaterView{}.refractiveIndex,
                               {.min = 1, .max = 3, .doc = "Refractive index; that of water is 1.33."}};

  void validate() const override;
};

/// The look of the fluid of a node.
class FluidSettings final : public Configurable {
 public:
  Param<std::string> node{*this, "node", "", {.doc = "Name of the node."}};
  Param<FluidLook> look{*this, "look", FluidLook::kWater, {.doc = "What its particles look like."}};
  Group<WaterSettings> water{*this, "water", "Of the look \"water\": what its inside does to light."};
  Group<FoamSettings> foam{*this, "foam", "Of the look \"water\": where it is white."};
  Param<float> smoothing{
      *this,
      "smoothing",
      2,
      {.unit = "spacings",
       .min = 0,
       .max = 20,
       .doc = "Of the look \"water\": width of the filter that makes one surface of the particles."}};
};

/// A view of it; `smoothing` is the width of the filter in metres.
WaterView waterView(const WaterSettings& settings, float smoothing, float foamOpacity);

}  // namespace rendering
}  // namespace weir
