// A scene: what a scene file says, as objects. Reading, validating and writing are in scene_file.h.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"

namespace WEIR_API weir {

/// The "world" section: what all nodes share.
class World final : public Configurable {
 public:
  Param<Vec3f> gravity{*this,
                       "gravity",
                       {0, -9.8f, 0},
                       {.unit = "m/s^2",
                        .live = true,
                        .animated = true,
                        .doc = "Acceleration of gravity.",
                        .also = "weight, acceleration, down"}};
  Param<double> dt{
      *this,
      "dt",
      0.001,
      {.unit = "s",
       .min = 0,
       .max = 1,
       .aboveMin = true,
       .doc = "Longest time step. A frame is divided into equal steps that are no longer than it.",
       .also = "time step"}};
  Param<std::optional<double>> cfl{
      *this,
      "cfl",
      std::nullopt,
      {.min = 0,
       .max = 1000,
       .aboveMin = true,
       .softMin = 0.1,
       .softMax = 2,
       .doc =
           "Makes steps as short as it takes that no particle flies farther than this many spacings in "
           "one, gravity included, and no longer than dt. Frames stay at their times. Without it all steps "
           "are equal."}};
  Param<std::optional<double>> minDt{
      *this,
      "min_dt",
      std::nullopt,
      {.unit = "s",
       .min = 0,
       .aboveMin = true,
       .doc = "With cfl: steps are not made shorter than this for the sake of fast particles; where they "
              "would have to be, that is counted and reported. A thousandth of dt if it is left out."}};
  Param<double> frameRate{*this,
                          "frame_rate",
                          30.0,
                          {.unit = "1/s",
                           .min = 0,
                           .max = 10000,
                           .aboveMin = true,
                           .doc = "Frames per simulated second.",
                           .also = "fps"}};
  Param<double> duration{
      *this,
      "duration",
      4.0,
      {.unit = "s", .min = 0, .max = 1e6, .doc = "Simulated time.", .also = "length, end, seconds, time"}};
  Param<std::int64_t> seed{*this, "seed", 1, {.min = 0, .doc = "Seed of all random numbers."}};

  void validate() const override;
  double shortestStep() const { return minDt.get().value_or(dt * 1e-3); }  ///< with cfl, s
};

struct Scene {
  /// Gives the world and the sections their values at a simulated time in s; the graph sees to its nodes.
  void animate(double time) {
    world.animate(time);
    for (const auto& [name, section] : sections) section->animate(time);
  }

  std::string title;
  std::string schema;             ///< the key "$schema", an address for editors; "" if there is none
  std::vector<FilePath> plugins;  ///< libraries that must be loaded before the scene can be built
  World world;
  SceneGraph graph;
  /// Sections that plugins registered, such as "render"; each is there, with defaults if the file has none.
  std::map<std::string, std::unique_ptr<Configurable>> sections;
  /// Sections of the file that no loaded plugin knows; kept for writing.
  std::map<std::string, Value> unknownSections;
  Value layout;      ///< the key "layout": where an editor shows the nodes; null if there is none
  std::string file;  ///< where it was read from; "" if from nowhere
  std::string text;  ///< kept with exported data: see textToKeep in scene_file.h
};

}  // namespace weir
