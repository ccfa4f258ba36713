// Counts the particles of a fluid in a box at every frame.
#pragma once

#include <weir/node.h>
#include <weir/particles.h>

namespace my_plugin {

using namespace weir;

class Probe final : public Node {
 public:
  static constexpr NodeInfo kInfo{"MyPluginProbe", "Counts the particles of a fluid in a box."};
  const NodeInfo& info() const override { return kInfo; }

  Param<Vec3f> min{*this, "min", {0, 0, 0}, {.unit = "m", .doc = "Lower corner of the box."}};
  Param<Vec3f> max{*this, "max", {1, 1, 1}, {.unit = "m", .doc = "Upper corner of the box."}};

  Input<Particles> fluid{*this, "fluid", "The particles to look at, a fluid's or others."};

  void validate() const override;
  void reset(const SetupContext& context) override;
  /// Called at every frame, when nodes may wait for the device.
  void frame(const StepContext& context) override;
  /// What `--stats` and `--series` show.
  void report(NodeReport& report) override;

 private:
  // What is declared so is kept by checkpoints: a resumed run goes on with it.
  State<std::int64_t> inside_{*this, "inside"}, maxInside_{*this, "max_inside"};
};

}  // namespace my_plugin
