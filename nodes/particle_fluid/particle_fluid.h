// A fluid made of particles: where all samplers, emitters and boundaries of one liquid meet.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/communication/shared_by_ranks.h"
#include "framework/graph/node.h"
#include "framework/particles/owned_particles.h"
#include "framework/particles/particle_batch.h"
#include "framework/particles/particles.h"
#include "framework/particles/periodic_images.h"
#include "framework/solids/solid_coupling.h"
#include "nodes/particle_fluid/bulk_energy.h"
#include "nodes/particle_fluid/events_of_all.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/inflow.h"
#include "nodes/particle_fluid/periodic_domain.h"
#include "nodes/particle_fluid/wall_field.h"
#include "nodes/static_boundary/boundary.h"

namespace WEIR_API weir {

class DividedParticles;
class PressureLaw;
struct FrameOnRanks;
struct InitialFluid;

/// The box around the particles of a fluid, and the sum of their positions.
struct FluidExtent {
  Aabb box;
  Vec3f sum;
};

/// On several ranks each owns a part of the particles and takes all steps with it. At every frame they find
/// together what is reported. If somebody looks at the particles, rank 0 gathers all of them, and those are
/// what it puts out.
class ParticleFluid final : public Node,
                            public OnRanks,
                            public OwnedParticles,
                            public SharedByRanks,
                            private SolidCoupling {
 public:
  static constexpr NodeInfo kInfo{
      "ParticleFluid",
      "An incompressible liquid, simulated with particles (semi-implicit incompressible SPH).",
      "water, liquid, fluid, sph, oil, honey, sea, simulation, solver, viscosity"};
  const NodeInfo& info() const override { return kInfo; }

  Param<float> spacing{
      *this,
      "spacing",
      0.01f,
      {.unit = "m",
       .min = 0,
       .max = 1000,
       .aboveMin = true,
       .softMin = 0.002,
       .softMax = 0.1,
       .doc = "Distance of particles at rest. It drives the emitters and samplers that are linked.",
       .also = "resolution, size, radius, detail, quality"}};
  Param<float> supportRatio{
      *this,
      "support_ratio",
      2,
      {.min = 1.1,
       .max = 3,
       .doc =
           "Radius in which particles interact, in spacings. 1.2 is the paper's, and 1.5 takes half the time "
           "of 2; below 1.8, fluid with few neighbours resists where it is squeezed through a narrow: jets "
           "are "
           "up to a tenth too slow."}};
  Param<float> restDensity{
      *this,
      "rest_density",
      1000,
      {.unit = "kg/m^3", .min = 0, .aboveMin = true, .doc = "Density at rest.", .also = "mass, weight"}};
  Param<std::optional<float>> bulkModulus{
      *this,
      "bulk_modulus",
      std::nullopt,
      {.unit = "Pa",
       .min = 0,
       .aboveMin = true,
       .doc =
           "Stiffness against compression; the speed of sound is sqrt(bulk_modulus / rest_density). If it "
           "is left out, it is 1 MPa, and with a solver that has a tolerance so much that the fluid's weight "
           "and first speed compress it by no more than that."}};
  Param<std::optional<float>> mu{
      *this,
      "mu",
      std::nullopt,
      {.unit = "J",
       .min = 0,
       .aboveMin = true,
       .doc = "The paper's stiffness, an energy per particle, in place of bulk_modulus = mu / spacing^3.",
       .also = "stiffness"}};
  Param<Calibration> calibration{*this,
                                 "calibration",
                                 Calibration::kPacking,
                                 {.doc = "Which arrangement of particles has rest density."}};
  Param<int> restSteps{*this,
                       "rest_steps",
                       3000,
                       {.min = 0,
                        .doc = "At most this many damped steps bring relaxed initial particles to rest in "
                               "their regions before the start; 0 leaves them as they were sampled."}};
  Param<bool> pressure{*this,
                       "pressure",
                       false,
                       {.doc = "Keep each particle's pressure as an attribute, for exports, pictures and "
                               "gauges; 4 bytes a particle."}};
  Param<std::optional<Vec3f>> domainMin{
      *this,
      "domain_min",
      std::nullopt,
      {.unit = "m", .doc = "Lower corner of the box in which particles live."}};
  Param<std::optional<Vec3f>> domainMax{
      *this,
      "domain_max",
      std::nullopt,
      {.unit = "m", .doc = "Upper corner of that box. Particles outside are removed and counted."}};
  Param<PeriodicAxes> periodic{
      *this,
      "periodic",
      PeriodicAxes::kNone,
      {.doc = "Axes along which the opposite faces of that box are joined: what leaves through one comes in "
              "through the other. A box of few spacings along one of them makes a flow in two dimensions.",
       .also = "cyclic, wrap, two dimensions, 2d, slab, channel"}};

  Inputs<ParticleBatch> initial{*this, "initial", "Particles that are there from the start."};
  Inputs<ParticleBatch> emitters{*this, "emitters", "Particles that are born in each step."};
  Inputs<Boundary> boundaries{*this, "boundaries", "Solids and containers that the fluid does not enter."};
  Inputs<SinkRegion> sinks{*this, "sinks", "Regions in which the fluid's particles are removed."};
  Output<Particles> fluid{*this, "fluid", "The fluid's particles."};

  ParticleFluid();
  ~ParticleFluid() override;

  PipelineBase* pipeline() override { return &pipeline_; }
  void validate() const override;
  void join(Communicator& ranks) override;
  void configure(const SetupContext& context) override;
  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void reset(const SetupContext& context) override;
  double longestStep(const StepContext& next, double cfl) override;
  void step(const StepContext& context) override;
  void frame(const StepContext& context) override;
  void report(NodeReport& report) override;
  void save(const StateWriter& to) const override;
  void restore(const StateReader& from) override;
  std::int64_t particleCount() const override;

  ParticleSet& owned() override { return state_->particles; }
  const Slabs* slabs() const override;
  void watch(bool watched) override { watched_ = watched; }
  Value ranksReport() const override;
  /// From its reset on.
  const FluidConstants& constants() const { return constants_; }
  /// Those of the last search, from the reset on; null before it.
  const NeighborList* neighbors() const { return state_ ? &state_->neighbors : nullptr; }
  /// Those that it meets, from the reset of the couplings on.
  const std::vector<Solid*>& solids() const { return state_->walls.solids; }

 private:
  /// What exists from reset on, on the device of that reset.
  struct State {
    explicit State(Device& device)
        : particles(device),
          neighbors(device),
          walls(device),
          extent(device, 1),
          speedSquared(device, 1),
          sinks(device),
          born(device),
          bornCount(device, 1),
          inflow(device) {}
    ParticleSet particles;
    std::optional<PeriodicImages> images;
    NeighborList neighbors;
    WallField walls;
    Array<FluidExtent> extent;
    Array<float> speedSquared;           // the largest
    Attribute<float> density, pressure;  // the latter if it is asked for
    std::vector<const Boundary*> boundaries;
    Array<SinkPiece> sinks;
    CellSort born;  // those of an emitter's particles that have room
    Array<int> bornCount;
    Inflow inflow;
    Vec3f gravity{};
    EventsOfAll events;
    EventsOfAll moreEvents;        // counted before a checkpoint, and not by this rank
    std::int64_t restSteps = 0;    // taken before the start
    std::optional<double> restDt;  // s, of those steps; empty once they are taken
    bool resumed = false;          // and no step made since
  };

  /// What is looked at: all particles, where this rank has gathered them.
  ParticleSet& shown() { return gathered_ ? *gathered_ : state_->particles; }
  State& makeState(Device& device);
  void appendInitial();
  void divideInitial();
  void releaseInitial();
  void tellOfShares(Log& log) const;
  /// How many particles a rank holds at most, of so many: its own, where slabs are not quite alike, and the
  /// copies that it sees of others'.
  struct ShareOfRank {
    double own = 0, halo = 0;
  };
  ShareOfRank shareOfRank(double all) const;
  /// Bytes on this rank's device, or for those that share the host's memory.
  double memoryOnRanks(Device& device, double all) const;
  /// The same of what rank 0 gathers.
  double memoryOfGathered(double all) const;
  /// Whether something looks at the particles of all ranks at every frame, so that rank 0 gathers them.
  bool isWatched() const;
  /// The particles sorted where this rank has them, with lists, before anyone looks.
  void sortOnRanks(const StepContext& context);
  void lookOnRanks();
  void gatherAll();
  void fitSlab(const Aabb& box, std::int64_t particles);
  /// The box around the particles of all ranks; empty if there are none.
  Aabb boxOnRanks(Device& device);
  void sumEvents();
  void sumSinksOfRanks();
  std::vector<int*> sinkCounters() const;
  void forgetSinks();
  void restoreOnRanks(const StateReader& from);
  void restoreEvents(const StateReader& from);
  /// The first step after a checkpoint was taken back.
  void goOn(const StepContext& context);
  /// By cell, of a grid that fits, with lists.
  void sortAlone(Device& device);
  void refreshLooks(const StepContext& context);

  std::int64_t accept(std::span<const std::unique_ptr<Solid>> solids) override;
  /// Removes the particles that have no room beside these; returns how many.
  std::int64_t carve(std::span<const std::unique_ptr<Solid>> solids);
  /// The enabled module that has the role; null if there is none.
  WallFinder* wallFinder() const;

  /// Of the enabled module that knows it; throws a scene Error if there is none.
  const BulkEnergy& bulkEnergy() const;
  /// The enabled module that has the role; null if there is none.
  const PressureLaw* pressureLaw() const;

  /// Where nobody gives it, once the particles are there.
  void chooseBulkModulus(const SetupContext& context);
  /// What is there at first, in a box that reaches down to where containers and the domain let it fall; with
  /// emitters, around all of these.
  InitialFluid fluidToCome(const SetupContext& context);
  /// Of the particles that this rank has.
  FluidExtent extentOf(Device& device);
  /// The box around it, as it is, and the largest speed.
  InitialFluid presentFluid(Device& device);
  double memoryFor(Device& device, double particles) const;
  /// Bytes on the device of the attributes that particles bring with them.
  double memoryOfBrought(double particles) const;
  FluidStep fluidStep(const StepContext& time);
  void resetModules(FluidStep& step);
  /// Before anyone looks and before the first step, when all solids are there.
  void relaxInitialState(const StepContext& context);
  /// Walls act on the lists of neighbours, too.
  void findWalls(const StepContext& context);
  void refresh(const StepContext& context);
  void runPipeline(FluidStep& step);
  Aabb domain() const;
  Period period() const;
  void checkPeriodic();
  void search();
  void checkEvents();
  void warnOfSettings(const SetupContext& context);
  /// What the emitter of that number has brought to the beginning of a step.
  void give(std::size_t emitter, double time);
  double largestSpeed();
  template <class Backend>
  void selectOn(Backend& device, const ParticleBatch& born);
  template <class Backend>
  void markInsideOn(Backend& device, const Array<SolidView>& solids, Array<int>& inside);
  template <class Backend>
  void boundingBoxOn(Backend& device, ArrayView<const Vec3f> positions, const Count& count);
  template <class Backend>
  void speedOn(Backend& device);
  template <class Backend>
  void densityOn(Backend& device);
  template <class Backend>
  void pressureOn(Backend& device);

  Pipeline<FluidModule> pipeline_;
  FluidConstants constants_;
  double maxParticles_ = 0;  // particles, as estimated; 0 if nobody asked
  std::optional<State> state_;
  // On several ranks.
  Communicator* ranks_ = nullptr;
  bool watched_ = true;
  std::unique_ptr<DividedParticles> divided_;
  std::optional<ParticleSet> gathered_;  // on rank 0, from the reset on, if somebody looks
  std::unique_ptr<FrameOnRanks> frame_;
  std::int64_t stepsTimed_ = 0;  // since the reset
};

}  // namespace weir
