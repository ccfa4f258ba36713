// What all emitters have in common: sheets of particles that leave a surface, one spacing behind another.
//
// An emitter describes one layer, points with the direction in which each moves, about one for every
// spacing² of its area. Layer k leaves when the flow has travelled k spacings, to a fraction of a step: the
// travel ∫ speed dt is carried from step to step, several layers may leave in one step, and after t seconds
// of flow exactly ⌈travel/spacing⌉ layers have left. So the flux in particles is
//
//   area·speed/spacing³
//
// up to the rounding of a layer to whole particles, which is reported where it is noticeable. Where keyframes
// give the speed, the travel is their exact integral, and the particles of a step leave with its mean speed.
#pragma once

#include <optional>
#include <vector>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/graph/node.h"
#include "framework/particles/inflow_role.h"
#include "framework/particles/particle_batch.h"

namespace WEIR_API weir {

class Emitter : public Node, public OnRanks, public FlowsIn {
 public:
  Param<float> speed{*this,
                     "speed",
                     1.0f,
                     {.unit = "m/s", .min = 0, .live = true, .animated = true, .doc = "Speed of the flow."}};
  Param<double> start{*this, "start", 0.0, {.unit = "s", .min = 0, .doc = "When the flow starts."}};
  Param<std::optional<double>> stop{
      *this,
      "stop",
      std::nullopt,
      {.unit = "s", .min = 0, .doc = "When the flow stops; never if it is left out."}};
  Param<std::optional<std::int64_t>> maxParticles{
      *this, "max_particles", std::nullopt, {.min = 0, .doc = "No more particles than this are emitted."}};
  Param<float> jitter{*this,
                      "jitter",
                      0,
                      {.min = 0,
                       .max = 0.5,
                       .doc = "Moves each particle at random by up to this share of the spacing along each "
                              "axis."}};
  Param<std::optional<std::int64_t>> seed{*this, "seed", std::nullopt, kSeedSpec};

  Output<ParticleBatch> particles{*this, "particles", "The particles born in this step."};

  void validate() const override;
  void estimate(const SetupContext& context, MemoryNeeds& needs) final;
  void reset(const SetupContext& context) final;
  /// That of the particles that leave in the step.
  double longestStep(const StepContext& next, double cfl) final;
  void step(const StepContext& context) final;
  void report(NodeReport& report) final;
  Flow flow() const final { return flow_; }

 protected:
  /// The points of a layer and the directions in which they leave, of length 1, in the frame of axes(). Or
  /// those of several layers, equally many each, that follow one another again and again.
  struct Layer {
    std::vector<Vec3f> points, directions;
    int layers = 1;
  };
  /// Where a layer's own axes are in the scene.
  struct Frame {
    Vec3f origin{}, xAxis{1, 0, 0}, yAxis{0, 1, 0}, zAxis{0, 0, 1};
  };

  virtual double area() const = 0;  ///< that the flow leaves through, m²
  /// How many particles makeLayer() will give, so that far too many are refused first.
  virtual double layerSize(float spacing) const = 0;
  /// How many layers makeLayer() will give.
  virtual int layersMade() const { return 1; }
  virtual Layer makeLayer(const SetupContext& context, float spacing) const = 0;
  /// Asked in each step.
  virtual Frame axes() const { return {}; }
  /// Of the fluid below; there is one when makeLayer() is called.
  ParticleBatch::Request request() const { return *particles.requested(); }
  std::uint64_t seedFor(const SetupContext& context) const { return randomSeed(*this, context, seed); }
  virtual double maxInLayer() const { return 1e7; }

 private:
  void checkLayerSize(const SetupContext& context) const;
  void warnOfSettings(const SetupContext& context) const;
  template <class Backend>
  void emitOn(Backend& device, std::int64_t count, double firstOffset, float flowSpeed);

  float spacing_ = 0;
  std::uint64_t seed_ = 0;
  Array<Vec3f> points_, directions_;               // of all layers that differ
  std::int64_t inLayer_ = 0;                       // points
  Flow flow_;                                      // of what was given in the present step
  State<double> travel_{*this, "travel"};          // m that the flow has moved since it started
  State<double> layers_{*this, "layers"};          // that have left, a whole number
  State<std::int64_t> emitted_{*this, "emitted"};  // particles that have left
};

}  // namespace weir
