// A scene: what a scene file says, as objects. Reading, validating and writing are in scene_file.h.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"

namespace weir {

/// The "world" section: what all nodes share.
class World final : public Configurable {
 public:
  Param<Vec3f> gravity{*this,
                       "gravity",
                       {0, -9.8f, 0},
                       {.unit = "m/s^2", .live = true, .animated = true, .doc = "Acceleration of gravity."}};
  Param<double> dt{
      *this,
      "dt",
      0.001,
      {.unit = "s",
       .min = 0,
       .max = 1,
       .aboveMin = true,
       .doc = "Longest time step. A frame is divided into equal steps that are no longer than it."}};
  Param<double> frameRate{
      *this,
      "frame_rate",
      30.0,
      {.unit = "1/s", .min = 0, .max = 10000, .aboveMin = true, .doc = "Frames per simulated second."}};
  Param<double> duration{
      *this, "duration", 4.0, {.unit = "s", .min = 0, .max = 1e6, .doc = "Simulated time."}};
  Param<std::int64_t> seed{*this, "seed", 1, {.min = 0, .doc = "Seed of all random numbers."}};
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
  std::string text;  ///< as it was read, with overrides not applied; kept with exported data
};

}  // namespace weir
