// The "render" section of a scene file: what the pictures show, and from where.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "framework/graph/configurable.h"
#include "plugins/views/cycles_settings.h"
#include "plugins/views/video_settings.h"
#include "plugins/views/view.h"
#include "plugins/views/water_settings.h"

namespace weir {

template <>
struct EnumNames<rendering::ColorMapName> {
  static constexpr std::array<EnumName, 5> kNames{
      EnumName{"viridis", "Dark blue to green to yellow."}, EnumName{"turbo", "Blue to green to red."},
      EnumName{"cividis", "Blue to yellow, for all kinds of colour vision."},
      EnumName{"coolwarm", "Blue to grey to red, for values around a middle."},
      EnumName{"water", "Deep blue to white, as of foam."}};
};

template <>
struct EnumNames<rendering::SurfaceLook> {
  static constexpr std::array<EnumName, 4> kNames{
      EnumName{"matt", "Opaque, without highlights."}, EnumName{"glass", "Transparent, with bright rims."},
      EnumName{"metal", "Opaque and shiny."},
      EnumName{"water", "The surface of a liquid: closed, and clear inside."}};
};

template <>
struct EnumNames<rendering::EnvironmentLook> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"studio", "A plain background; mirrors show a pale room with lamps."},
      EnumName{"sky", "A blue sky with clouds, and the ground to the horizon."},
      EnumName{"image", "The picture of the parameter image."}};
};

template <>
struct EnumNames<rendering::ToneCurve> {
  static constexpr std::array<EnumName, 2> kNames{
      EnumName{"plain", "Colours as they are, but for a soft shoulder where there is too much light."},
      EnumName{"filmic", "The contrast of film, with paler highlights."}};
};

namespace rendering {

/// Which particles are drawn.
enum class ParticleDisplay { kAuto, kAll, kNone };

}  // namespace rendering

template <>
struct EnumNames<rendering::ParticleDisplay> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"auto", "Those of fluids whose surface is not shown."}, EnumName{"all", "All."},
      EnumName{"none", "None."}};
};

namespace rendering {

/// One moment of a moving camera; what is between them, see camera_path.h.
class CameraKey final : public Configurable {
 public:
  Param<double> time{*this, "time", 0.0, {.unit = "s", .min = 0, .doc = "Simulated time of this moment."}};
  Param<Vec3f> eye{*this, "eye", {2, 1.5f, 2}, {.unit = "m", .doc = "Where the camera is."}};
  Param<Vec3f> target{*this, "target", {}, {.unit = "m", .doc = "What it looks at."}};
  Param<std::optional<float>> fov{*this,
                                  "fov",
                                  std::nullopt,
                                  {.unit = "degrees",
                                   .min = 1,
                                   .max = 170,
                                   .doc = "Vertical field of view; the camera's if it is left out."}};
};

class CameraSettings : public Configurable {
 public:
  Param<std::optional<Vec3f>> eye{
      *this,
      "eye",
      std::nullopt,
      {.unit = "m", .doc = "Where the camera is. Without it the camera sees the whole scene."}};
  Param<std::optional<Vec3f>> target{
      *this, "target", std::nullopt, {.unit = "m", .doc = "What it looks at."}};
  Param<Vec3f> up{*this, "up", {0, 1, 0}, {.doc = "The direction that is up in the picture."}};
  Param<float> fov{
      *this, "fov", 40, {.unit = "degrees", .min = 1, .max = 170, .doc = "Vertical field of view."}};
  GroupList<CameraKey> keyframes{*this, "keyframes",
                                 "Moments of a moving camera, in the order of their times."};
  Param<bool> smooth{
      *this,
      "smooth",
      true,
      {.doc = "Between keyframes the camera goes smoothly, and starts and stops gently; or else on straight "
              "lines."}};
  Param<std::optional<float>> orbitPeriod{
      *this,
      "orbit_period",
      std::nullopt,
      {.unit = "s",
       .doc = "Time in which the camera goes once around its target, about the direction up; negative: the "
              "other way round. Without it there is no orbit."}};
  Param<std::string> follow{
      *this,
      "follow",
      "",
      {.doc = "Name of a node that the camera follows: its target is the middle of that fluid or mesh, and "
              "the eye keeps its distance and direction from there."}};

  void validate() const override;
};

/// A camera beside the first one, whose pictures go to places of their own.
class NamedCameraSettings final : public CameraSettings {
 public:
  Param<std::string> name{
      *this,
      "name",
      "",
      {.doc = "What its pictures are told apart by, run.NAME.mp4 and DIR/NAME: letters, digits, _ "
              "and -."}};

  void validate() const override;
};

class ColorSettings final : public Configurable {
 public:
  Param<std::string> by{
      *this,
      "by",
      "speed",
      {.doc =
           "What colours the particles: speed, or any attribute such as density; \"none\" for one colour."}};
  Param<std::optional<Vec2f>> range{
      *this,
      "range",
      std::nullopt,
      {.doc = "Values at the two ends of the colour map; found from the first frames if it is left out."}};
  Param<ColorMapName> map{*this, "map", ColorMapName::kViridis, {.doc = "The colours."}};
  Param<std::vector<Color>> table{*this,
                                  "table",
                                  {},
                                  {.doc = "Colours of one's own in place of map: [red, green, blue] from 0 "
                                          "to 1 or \"#rrggbb\", evenly spread from "
                                          "low to high values."}};
  Param<FilePath> file{*this,
                       "file",
                       {},
                       {.doc = "A file of colours in place of map: .csv with red, green and blue in each "
                               "line, or a value before them, or a .json preset of ParaView."}};
  Param<Color> fixed{
      *this, "fixed", {0.16f, 0.45f, 0.85f, 1}, {.doc = "The one colour for \"by\": \"none\"."}};
  /// That of the table or the file, or else the one that is named. Throws an io Error if the file is wrong.
  ColorMap colorMap() const;
  Param<bool> bar{*this, "bar", true, {.doc = "Show the colours with their values."}};

  void validate() const override;
};

/// Hides particles on one side of a plane, or leaves a slice.
class ClipSettings final : public Configurable {
 public:
  Param<Vec3f> point{*this, "point", {}, {.unit = "m", .doc = "A point of the plane."}};
  Param<Vec3f> normal{*this,
                      "normal",
                      {0, 0, 1},
                      {.doc = "Across the plane; particles on the side where it points are hidden."}};
  Param<std::optional<float>> thickness{
      *this,
      "thickness",
      std::nullopt,
      {.unit = "m",
       .min = 1e-9,
       .doc = "With it, only the slice of this thickness is shown that has the plane as its middle."}};

  void validate() const override;
};

/// Arrows along the velocities of particles.
class ArrowSettings final : public Configurable {
 public:
  Param<std::optional<float>> spacing{
      *this,
      "spacing",
      std::nullopt,
      {.unit = "m",
       .min = 1e-9,
       .doc = "There is one arrow for each cube of this size that holds particles, of their mean velocity. "
              "Without it there are no arrows."}};
  Param<float> seconds{
      *this,
      "seconds",
      0.05f,
      {.unit = "s", .min = 1e-9, .doc = "An arrow is as long as the way that is gone in this time."}};
  Param<Color> color{*this, "color", {0.08f, 0.09f, 0.11f, 0.9f}, {.doc = "Their colour."}};
  Param<float> width{*this,
                     "width",
                     1.6f,
                     {.unit = "pixels",
                      .min = 0.1,
                      .max = 100,
                      .doc = "Width of their lines in a picture that is 720 pixels high."}};
};

/// The look of the surface that a node puts out, be it solid or a fluid's.
class SurfaceSettings final : public Configurable {
 public:
  Param<std::string> node{*this, "node", "", {.doc = "Name of the node."}};
  Param<SurfaceLook> look{*this, "look", SurfaceLook::kMatt, {.doc = "Kind of material."}};
  Param<std::optional<Color>> color{
      *this,
      "color",
      std::nullopt,
      {.doc = "Colour; of glass, the colour that light has behind it. Without it, light grey or clear, and "
              "for fluids the particles' one colour."}};
  Param<bool> particleColors{
      *this,
      "particle_colors",
      false,
      {.doc = "Of a matt or metal surface of a fluid: it has the colours that its particles have by color."}};
  Group<WaterSettings> water{*this, "water", "Of the look \"water\": what its inside does to light."};
  Param<bool> visible{*this, "visible", true, {.doc = "Whether it is shown."}};

  /// The colour that is given, or else that of the look.
  Color shownColor() const;
  void validate() const override;
};

/// A number of the statistics over time, in the corner of the pictures.
class PlotSettings final : public Configurable {
 public:
  Param<std::string> of{
      *this,
      "of",
      "",
      {.doc = "The number, as --series and --stats name it: \"particles\", or node and name, "
              "\"water.kinetic_energy\"."}};
  Param<std::string> label{
      *this, "label", "", {.doc = "What it is called in the picture; of if it is empty."}};
  Param<std::string> unit{*this, "unit", "", {.doc = "Its unit."}};

  /// "kinetic energy in J"
  std::string caption() const;
};

/// Light and surroundings.
class EnvironmentSettings final : public Configurable {
 public:
  Param<EnvironmentLook> look{*this, "look", EnvironmentLook::kStudio, {.doc = "What surrounds the scene."}};
  Param<FilePath> image{
      *this,
      "image",
      {},
      {.doc = "Of the look \"image\": a Radiance file (.hdr) of all directions, twice as wide "
              "as high. It is mirrored, and gives the light that comes from all sides."}};
  Param<float> turn{*this,
                    "turn",
                    0,
                    {.unit = "degrees",
                     .min = -360,
                     .max = 360,
                     .doc = "Turns the image to its left; without that its middle is in the direction -z."}};
  Param<float> brightness{*this,
                          "brightness",
                          1,
                          {.min = 0,
                           .max = 1000,
                           .aboveMin = true,
                           .doc = "Multiplies the light of the image; white paper in the sun is about 1."}};
  Param<bool> background{
      *this, "background", true, {.doc = "Whether the image is the background; or else that is plain."}};
  Param<Vec3f> sun{*this,
                   "sun",
                   LightingView{}.towardsSun,
                   {.doc = "The direction towards the sun, of any length. Without it the sun of an image is "
                           "where that is brightest."}};
  Param<float> sunStrength{
      *this, "sun_strength", 1, {.min = 0, .max = 100, .doc = "Multiplies the light of the sun alone."}};
  Param<float> exposure{
      *this, "exposure", 1, {.min = 0, .max = 100, .aboveMin = true, .doc = "Multiplies all light."}};
  Param<ToneCurve> tone{*this, "tone", ToneCurve::kPlain, {.doc = "How light becomes colours."}};
  Param<float> groundTiles{
      *this,
      "ground_tiles",
      0,
      {.unit = "m",
       .min = 0,
       .doc = "Side of the tiles of the floor, which make refraction seen; 0: no tiles."}};
  Param<Color> groundColor{*this, "ground_color", GroundView{}.color, {.doc = "Colour of the floor."}};

  void validate() const override;
};

class RenderSettings final : public Configurable {
 public:
  Group<CameraSettings> camera{*this, "camera", "The camera."};
  GroupList<NamedCameraSettings> cameras{*this, "cameras", "More cameras, each with pictures of its own."};
  Param<PictureEngine> engine{
      *this, "engine", PictureEngine::kWeir, {.doc = "What draws pictures; --engine in the command line."}};
  Group<CyclesSettings> cycles{*this, "cycles", "Of the engine \"cycles\": how it draws."};
  Group<EnvironmentSettings> environment{*this, "environment", "Light and surroundings."};
  Group<ColorSettings> color{*this, "color", "The colours of the particles."};
  GroupList<FluidSettings> fluids{*this, "fluids",
                                  "The looks of fluids, by node; those that are not here are spheres."};
  GroupList<ClipSettings> clips{*this, "clips", "Planes that cut the fluids open."};
  Group<ArrowSettings> arrows{*this, "arrows", "Arrows that show velocities."};
  GroupList<SurfaceSettings> surfaces{*this, "surfaces", "The looks of surfaces, by node."};
  Param<int> width{
      *this, "width", 1280, {.unit = "pixels", .min = 16, .max = 16384, .doc = "Width of the pictures."}};
  Param<int> height{
      *this, "height", 720, {.unit = "pixels", .min = 16, .max = 16384, .doc = "Height of the pictures."}};
  Param<float> particleSize{
      *this,
      "particle_size",
      1.0f,
      {.min = 0.05, .max = 4, .doc = "Diameter of the drawn spheres, in particle spacings."}};
  Param<ParticleDisplay> particles{
      *this, "particles", ParticleDisplay::kAuto, {.doc = "Which particles are shown."}};
  Param<bool> ground{*this, "ground", true, {.doc = "Show a floor under the scene."}};
  Param<bool> transparent{
      *this,
      "transparent",
      false,
      {.doc = "Pictures have nothing behind the scene, to be laid over others. Of the floor, its shadows "
              "alone are there; \"ground\": false leaves them out."}};
  Group<VideoSettings> video{*this, "video", "How --video encodes."};
  Param<bool> outlines{*this, "outlines", true, {.doc = "Show the edges of boxes that hold the fluid."}};
  GroupList<PlotSettings> plots{*this, "plots", "Numbers that are plotted in a corner of the pictures."};
  Param<bool> overlay{*this, "overlay", true, {.doc = "Show title, time and number of particles."}};
  Param<Color> backgroundTop{
      *this, "background_top", {0.78f, 0.84f, 0.9f, 1}, {.doc = "Background at the top."}};
  Param<Color> backgroundBottom{
      *this, "background_bottom", {0.95f, 0.96f, 0.97f, 1}, {.doc = "Background at the bottom."}};

  void validate() const override;
};

}  // namespace rendering
}  // namespace weir
