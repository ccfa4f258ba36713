// What all samplers have in common: they fill a region with particles at the spacing of the fluid below.
//
// A region has as many particles as it has cubes of the spacing, within 1 % where it is 8 spacings wide: the
// nodes of a cubic lattice, or of one that is stretched to fit (lattice.h). Where the fluid's rest state is
// disordered, their arrangement is that of fluid at rest: the lattice's nodes are moved as in a RelaxedTile,
// and what would be outside is mirrored at the region's surface. The fluid then lets them come to rest in the
// region, as if that were a container, before the simulation starts (see RestState).
//
// Whether a node is inside and where its particle is depend on that node alone, so ranks take chunks of nodes
// by turns.
#pragma once

#include <array>
#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/graph/node.h"
#include "framework/particles/arrangement.h"
#include "framework/particles/made_by_ranks.h"
#include "framework/particles/particle_batch.h"
#include "nodes/samplers/lattice.h"
#include "nodes/static_boundary/boundary.h"

namespace WEIR_API weir {

class Sampler : public Node, public OnRanks, public MadeByRanks {
 public:
  explicit Sampler(StartPressure usual = StartPressure::kAuto)
      : pressure(*this, "pressure", usual, {.doc = "Of a relaxed arrangement at the start."}) {}

  Param<Vec3f> velocity{*this, "velocity", {}, {.unit = "m/s", .doc = "Of all particles at the start."}};
  Param<float> jitter{*this,
                      "jitter",
                      0,
                      {.min = 0,
                       .max = 0.5,
                       .doc = "Moves each particle at random by up to this share of the spacing along each "
                              "axis."}};
  Param<std::optional<Arrangement>> arrangement{
      *this,
      "arrangement",
      std::nullopt,
      {.doc = "If it is left out: relaxed for fluids with the calibration `packing`, else lattice."}};
  Param<std::optional<std::int64_t>> seed{*this, "seed", std::nullopt, kSeedSpec};
  Param<StartPressure> pressure;

  Output<ParticleBatch> particles{*this, "particles", "The particles, there from the start."};

  void join(Communicator& ranks) final { ranks_ = &ranks; }
  /// Those who read the particles share them by ranks, too, or else each rank has all.
  BatchPart* part() final { return makesPart() ? &part_ : nullptr; }
  bool rests() const final { return relaxed(); }
  void estimate(const SetupContext& context, MemoryNeeds& needs) final;
  /// Those who read the particles have done so in reset(), at the first frame or, if there was none, in the
  /// first step.
  void step(const StepContext& context) final;
  void frame(const StepContext& context) final;
  void report(NodeReport& report) final;

 protected:
  /// The region: the outside of it as a solid, and how far from it particles are at least.
  struct Region {
    std::shared_ptr<Boundary> outside;
    float contact = 0;  // m
  };

  /// How many particles fill() will make at most, for the spacing that the fluid asks for.
  virtual double maxParticleCount() const = 0;
  /// Bytes on the device of what a relaxed arrangement takes beside its particles.
  virtual double regionMemory() const { return 0; }
  /// What the fluid below asks for; throws a scene Error if there is none.
  float requestedSpacing() const;
  /// How many ranks make its particles together.
  int makers() const { return makesPart() ? ranks_->size() : 1; }
  /// The fluid's periodic domain along the axes along which the box fills it; along no other.
  Period filledPeriod(const Aabb& box) const;
  bool relaxed() const;
  /// Puts out the particles of the nodes that are inside; throws a scene Error if there are none. Of several
  /// lattices the first counts whose nodes inside fill `volume` (m³) within Lattice::kExact, or else the one
  /// that is nearest to it. `region` is asked for a relaxed arrangement alone. Along a period that it fills,
  /// the lattice is stretched such that it goes on through the faces.
  void fill(const SetupContext& context, const std::vector<Lattice>& lattices, double volume,
            const std::function<Region()>& region, const std::function<bool(const Vec3f&)>& inside = {},
            const Period& filled = {});
  /// The region of a shape, whose particles are half a spacing from its surface.
  Region regionOf(const SetupContext& context, Shape shape) const;
  /// Warns if the fluid in a period that it fills is not at rest density, as that is no whole number of
  /// spacings long.
  void warnOfStretch(const SetupContext& context, const Lattice& lattice, const Period& filled) const;
  /// Warns if the particles put out fill much more or less than `volume` m³.
  void warnOfRounding(const SetupContext& context, double volume, float spacing) const;

  /// Warns of a region of that thickness, in m, if it has room for few particles across it only.
  void warnOfThinness(const SetupContext& context, double thickness, float spacing) const;

 private:
  bool makesPart() const;
  /// How many particles all who make them have found.
  std::int64_t countOfAll(const LatticePoints& points) const;
  void put(Device& device, LatticePoints points);
  void putInside(const SetupContext& context, const Region& region);
  template <class Backend>
  void putInsideOn(Backend& device, const Region& region);

  Communicator* ranks_ = nullptr;
  BatchPart part_;
  std::int64_t sampled_ = 0;  // by all ranks
  bool seen_ = false;         // at a frame, since the reset
};

}  // namespace weir
