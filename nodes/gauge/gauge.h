// Measures particles at a point, along a line, through a plane or in a box, for --stats, --series and plots.
//
// Values between particles are Shepard sums with the kernel W(r) = 315/(64π·H³)·(1 − r²/H²)³ (Müller et al.
// 2003) of H = 2 spacings: f(x) = Σ V·W·f_i / Σ V·W. The sum of V·W alone, `filled`, is 1 within fluid, 1/2
// at a flat surface and 0 where there is nothing. A single drop has 0.2.
//
// The flow through a plane is Q = Σ V·(v·n)·δ(s), s being the signed distance and δ a hat of 2 spacings to
// each side with ∫δ ds = 1: a particle that passes adds its volume once, whatever the step.
#pragma once

#include <array>
#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/graph/node.h"
#include "framework/particles/particles.h"

namespace WEIR_API weir {

enum class GaugeShape { kPoint, kLine, kPlane, kBox };
template <>
struct EnumNames<GaugeShape> {
  static constexpr std::array<EnumName, 4> kNames{
      EnumName{"point", "filled, velocity, density and pressure at position."},
      EnumName{"line",
               "Along the line from position to end: the height of the surface, and the length in fluid."},
      EnumName{"plane",
               "The flow through the plane at position, along normal, and the volume that has passed."},
      EnumName{"box", "From min to max: particles, volume, mass, velocity, energy, density and pressure."}};
};

class Gauge final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{
      "Gauge", "Measures particles at a point, along a line, through a plane or in a box.",
      "probe, sensor, measure, height, level, flow, flux, discharge, pressure, velocity"};
  const NodeInfo& info() const override { return kInfo; }

  Param<GaugeShape> shape{*this, "shape", GaugeShape::kPoint, {.doc = "Where it measures, and what."}};
  Param<Vec3f> position{*this,
                        "position",
                        {},
                        {.unit = "m",
                         .doc = "The point, the beginning of the line, or the middle of the plane.",
                         .onlyFor = "shape: point, line, plane"}};
  Param<Vec3f> end{
      *this, "end", {0, 1, 0}, {.unit = "m", .doc = "The end of the line.", .onlyFor = "shape: line"}};
  Param<Vec3f> normal{
      *this,
      "normal",
      {0, 1, 0},
      {.doc = "The way in which flow counts as positive; of any length but 0.", .onlyFor = "shape: plane"}};
  Param<std::optional<float>> radius{
      *this,
      "radius",
      std::nullopt,
      {.unit = "m",
       .min = 0,
       .aboveMin = true,
       .doc = "Of the disc of the plane through which flow counts; all of the plane if it is left out.",
       .onlyFor = "shape: plane"}};
  Param<Vec3f> min{*this,
                   "min",
                   {-0.5f, 0, -0.5f},
                   {.unit = "m", .doc = "Lower corner of the box.", .onlyFor = "shape: box"}};
  Param<Vec3f> max{*this,
                   "max",
                   {0.5f, 1, 0.5f},
                   {.unit = "m", .doc = "Upper corner of the box.", .onlyFor = "shape: box"}};

  Input<Particles> particles{*this, "particles", "The particles to measure, a fluid's or others."};

  void validate() const override;
  void join(Communicator& ranks) override;
  void reset(const SetupContext& context) override;
  /// Counts what passes a plane.
  void step(const StepContext& context) override;
  /// What its shape measures, see docs/measure.md. Numbers of a place without particles are left out.
  void report(NodeReport& report) override;

 private:
  /// Of these particles, which the ranks share if there are any.
  template <class Backend>
  void flowOn(Backend& device, const Particles& of, Communicator* ranks, double dt);
  void measureFlow(double dt);
  void checkPlane() const;

  Communicator* ranks_ = nullptr;  // null without
  // The flow in m³/s, and the volume that has passed, in m³.
  State<Array<double>> flow_{*this, "flow"};
};

}  // namespace weir
