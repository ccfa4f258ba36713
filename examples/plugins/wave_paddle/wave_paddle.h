// A wave maker: meshes that a drive moves to and fro, as it has the force to, in a fluid.
//
// The drive wants the position stroke/2·sin(2π·t/period), faded in over the first `ramp` seconds, and follows
// it as far as its largest acceleration lets it. Its position and velocity are State members of the node, so
// that checkpoints hold them: after
// each step it chooses the velocity of the next, with which the paddle then moves evenly,
//
//   v ← v + clamp(w(t) − v, ±a·dt),     w(t) = (wanted(t + dt) − x)/dt
//
// so that the state depends on the steps that were made, whatever their lengths. Solids in motion are taken
// care of by the fluid itself (framework/solids).
#pragma once

#include <memory>
#include <vector>

#include <weir/mesh.h>
#include <weir/node.h>
#include <weir/particles.h>
#include <weir/solid.h>

namespace wave_paddle {

using namespace weir;

class WavePaddle final : public Node, public RigidMotion {
 public:
  static constexpr NodeInfo kInfo{"WavePaddle", "Moves meshes to and fro, to make waves."};
  const NodeInfo& info() const override { return kInfo; }

  Param<Vec3f> direction{
      *this, "direction", {1, 0, 0}, {.doc = "Which way the paddle goes; of any length but 0."}};
  Param<float> stroke{
      *this, "stroke", 0.1f, {.unit = "m", .min = 0, .doc = "From one end of its way to the other."}};
  Param<float> period{*this, "period", 1, {.unit = "s", .min = 0, .aboveMin = true, .doc = "Period."}};
  Param<float> ramp{
      *this, "ramp", 1, {.unit = "s", .min = 0, .doc = "Time in which it reaches its whole stroke."}};
  Param<float> acceleration{*this,
                            "acceleration",
                            50,
                            {.unit = "m/s^2", .min = 0, .aboveMin = true, .doc = "The most of the drive."}};

  Inputs<Particles> fluid{*this, "fluid", "The fluids in which it makes waves.", true};
  Inputs<TriangleMesh> solids{*this, "solids", "The paddle, where it is at time 0.", true};

  void validate() const override;
  void configure(const SetupContext& context) override;
  void reset(const SetupContext& context) override;
  double longestStep(const StepContext& next, double cfl) override;
  /// Comes after the step of the fluids, which are above it.
  void step(const StepContext& context) override;
  void frame(const StepContext& context) override;
  void report(NodeReport& report) override;

  Pose poseAt(double time) const override;
  Vec3f pivotAt(double time) const override { return poseAt(time).translation; }

 private:
  double wantedAt(double time) const;
  void chooseVelocity(double time, double dt);

  State<std::vector<std::unique_ptr<Solid>>> parts_{*this, "parts"};
  // At the beginning of the step that comes next.
  State<double> time_{*this, "time"};          // s
  State<double> position_{*this, "position"};  // m
  State<double> velocity_{*this, "velocity"};  // m/s
  State<double> force_{*this, "force"};        // N along the direction, mean since the frame before
  State<double> lastFrame_{*this, "last_frame"};
};

}  // namespace wave_paddle
