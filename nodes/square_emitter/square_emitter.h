// A rectangular nozzle that lets particles out in layers.
//
// The nozzle spans the node's local x and z axes around its position; the jet leaves along local -y. Layers
// are one particle spacing apart along the jet and are placed to a fraction of a step, so the flux is exact:
// after t seconds of flow, floor(speed·t/spacing) + 1 layers have passed the nozzle.
#pragma once

#include "framework/graph/node.h"
#include "nodes/particles/particle_batch.h"

namespace weir {

class SquareEmitter final : public Node {
 public:
  static constexpr NodeInfo kInfo{"SquareEmitter",
                                  "A rectangular nozzle that emits a jet of particles along its -y axis."};
  const NodeInfo& info() const override { return kInfo; }

  Param<Vec3f> position{*this, "position", {}, {.unit = "m", .doc = "Centre of the nozzle."}};
  Param<Rotation> rotation{
      *this,
      "rotation",
      {},
      {.unit = "degrees", .doc = "Turns the nozzle; without it the jet points down (-y)."}};
  Param<float> width{*this,
                     "width",
                     0.1f,
                     {.unit = "m",
                      .min = 0,
                      .aboveMin = true,
                      .doc = "Size along the nozzle's x axis, rounded to whole particles."}};
  Param<float> height{*this,
                      "height",
                      0.1f,
                      {.unit = "m",
                       .min = 0,
                       .aboveMin = true,
                       .doc = "Size along the nozzle's z axis, rounded to whole particles."}};
  Param<float> speed{*this, "speed", 1.0f, {.unit = "m/s", .min = 0, .doc = "Speed of the jet."}};
  Param<double> start{*this, "start", 0.0, {.unit = "s", .min = 0, .doc = "When the flow starts."}};
  Param<std::optional<double>> stop{
      *this,
      "stop",
      std::nullopt,
      {.unit = "s", .min = 0, .doc = "When the flow stops; never if it is left out."}};
  Param<std::optional<std::int64_t>> maxParticles{
      *this,
      "max_particles",
      std::nullopt,
      {.min = 0, .doc = "No more particles than this leave the nozzle."}};

  Output<ParticleBatch> particles{*this, "particles", "The particles born in this step."};

  void validate() const override;
  void reset(const SetupContext& context) override;
  void step(const StepContext& context) override;
  void report(NodeReport& report) override;

 private:
  template <class Backend>
  void emitOn(Backend& device, std::int64_t count, double firstOffset);

  float spacing_ = 0;
  int columns_ = 0, rows_ = 0;  // particles of a layer along x and z
  double travel_ = 0;           // m that the jet has moved since it started
  std::int64_t layers_ = 0;     // layers that have left
  std::int64_t emitted_ = 0;    // particles that have left
};

}  // namespace weir
