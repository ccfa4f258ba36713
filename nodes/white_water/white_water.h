// Spray, foam and bubbles of a fluid, as particles of their own (Ihmsen, Akinci, Akinci and Teschner, Unified
// spray, foam and air bubbles for particle-based fluids, The Visual Computer 28, 2012).
//
// A particle of the fluid, of volume V, makes on average
//
//   V^⅔·dt·Φ_speed·(trapped_air·Φ_air + wave_crests·Φ_crest)
//
// of them in a step. Each Φ rises from 0 to 1 within the limits of its quantity. With W of fluid_grid.h and
// sums over the particles within its radius these are
//
//   Φ_speed   |v|²/2, which the limits give by the speed
//   Φ_air     Σ V·W·|v_ij|·(1 − v̂_ij·x̂_ij), m/s: how differently what is near moves, and twice of what comes
//             nearer
//   Φ_crest   Σ V·W·(n_j − n_i)·x_ji / Σ V·W·x_ji², 1/m: the mean curvature, over what has a normal n; where
//             v̂·n ≥ 0.6 and no wall is within the radius
//
// They are born along the way that the particle went in the step, around it, with its velocity. By how much
// fluid is around, each is spray, foam or a bubble, anew in every step:
//
//   spray    dv/dt = g − air_drag·v
//   foam     v = v_fluid + s·u, from s = −1 half a spacing above the surface to 1 as far below: it comes to
//            lie on the surface, and stays there where water goes down, so that it gathers
//   bubble   dv/dt = (v_fluid + u − v)/τ, where u is rise_speed against gravity and τ = rise_speed/(2·|g|),
//            as what displaces water, whose mass it has to move, starts with twice gravity
//
// White water goes in steps of its own, of as many of the fluid's as last no longer than max_dt; one ends at
// each frame. They are exact for a fluid that does not change in them, and of second order for foam in one
// that does. Lifetimes run while a particle is spray or foam, and faster for foam on films, whose water runs
// off: where the fluid ends within a radius below it, 1/film_lifetime times as fast.
//
// Where ranks share the fluid, they share its white water by the same slabs: a particle goes to the rank in
// whose slab it will be, where the fluid around it is (remote_fluid.h), and is made by the rank whose
// particle of the fluid makes it. Each that is made gets the id that it would get on one rank.
#pragma once

#include <memory>
#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/communication/shared_by_ranks.h"
#include "framework/graph/node.h"
#include "framework/particles/divided_particles.h"
#include "framework/particles/owned_particles.h"
#include "framework/particles/particle_batch.h"
#include "framework/particles/particles.h"
#include "nodes/white_water/fluid_grid.h"
#include "nodes/white_water/remote_fluid.h"
#include "nodes/white_water/walls_of_fluid.h"

namespace WEIR_API weir {

struct FluidWalls;
struct WhiteParticles;

class WhiteWater final : public Node, public OnRanks, public OwnedParticles, public SharedByRanks {
 public:
  static constexpr NodeInfo kInfo{
      "WhiteWater", "Spray, foam and bubbles of a fluid, as particles of their own.",
      "whitewater, foam, spray, bubbles, splash, mist, air, surf, wave, secondary"};
  const NodeInfo& info() const override { return kInfo; }

  Param<float> trappedAir{
      *this,
      "trapped_air",
      2e6f,
      {.unit = "1/(m^2 s)",
       .min = 0,
       .softMax = 2e7,
       .doc = "How many are made in a second by a square metre of fluid that whirls, where air is trapped.",
       .also = "amount, density, rate, turbulence"}};
  Param<float> waveCrests{
      *this,
      "wave_crests",
      2e6f,
      {.unit = "1/(m^2 s)",
       .min = 0,
       .softMax = 2e7,
       .doc = "How many are made in a second by a square metre of the sharp crests of waves.",
       .also = "amount, density, rate, breaking"}};
  Param<Vec2f> airLimits{*this,
                         "air_limits",
                         {0.2f, 1.2f},
                         {.unit = "m/s",
                          .min = 0,
                          .doc = "Differences of velocity up to which no air is trapped, and from which on "
                                 "as much as can be."}};
  Param<Vec2f> crestLimits{
      *this,
      "crest_limits",
      {5, 30},
      {.unit = "1/m",
       .min = 0,
       .doc = "Curvatures up to which a wave is smooth, and from which on it is as sharp as can be."}};
  Param<Vec2f> speedLimits{
      *this,
      "speed_limits",
      {0.5f, 3},
      {.unit = "m/s",
       .min = 0,
       .doc = "Speeds up to which fluid makes nothing, and from which on as much as it can."}};
  Param<Vec2f> lifetime{
      *this,
      "lifetime",
      {1, 4},
      {.unit = "s",
       .min = 0,
       .doc = "Shortest and longest time as spray and foam; that as a bubble does not count."}};
  Param<float> filmLifetime{
      *this,
      "film_lifetime",
      0.25f,
      {.min = 0,
       .max = 1,
       .aboveMin = true,
       .doc = "How long foam lasts on films no thicker than a spacing, whose water runs "
              "off, as a share of its lifetime on deep water.",
       .also = "drain, burst, dissolve, thin sheets"}};
  Param<Vec2f> radius{*this,
                      "radius",
                      {0.0005f, 0.0015f},
                      {.unit = "m",
                       .min = 0,
                       .aboveMin = true,
                       .doc = "Smallest and largest radius; pictures show smaller ones.",
                       .also = "size"}};
  Param<float> airDrag{*this,
                       "air_drag",
                       1.5f,
                       {.unit = "1/s",
                        .min = 0,
                        .softMax = 10,
                        .doc = "Rate at which air stops spray; drops of 1 mm fall at gravity/air_drag."}};
  Param<float> riseSpeed{*this,
                         "rise_speed",
                         0.25f,
                         {.unit = "m/s", .min = 0, .softMax = 1, .doc = "Of bubbles in fluid at rest."}};
  Param<std::int64_t> maxParticles{
      *this,
      "max_particles",
      1000000,
      {.min = 0, .max = 2e9, .doc = "No more at a time than this; while there are so many, fewer are made."}};
  Param<double> maxDt{*this,
                      "max_dt",
                      0.01,
                      {.unit = "s",
                       .min = 0,
                       .softMax = 0.05,
                       .doc = "Longest step of white water; the fluid's own if they are longer. Long ones "
                              "cost less, and short ones follow violent fluid more closely.",
                       .also = "substeps, time step"}};
  Param<std::optional<std::int64_t>> seed{*this, "seed", std::nullopt, kSeedSpec};

  Input<Particles> fluid{
      *this, "fluid",
      "The fluid. White water meets its boundaries and solids, and is removed by its sinks "
      "and domain."};
  Output<Particles> particles{*this, "particles", "Spray, foam and bubbles."};

  void validate() const override;
  void join(Communicator& ranks) override;
  void configure(const SetupContext& context) override;
  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void reset(const SetupContext& context) override;
  void step(const StepContext& context) override;
  void frame(const StepContext& context) override;
  /// As max_dt were the time between frames. Not where forces move solids, as recordings do not hold where
  /// they were.
  bool followsRecordings() const override;
  /// How many there are of each kind, were made, and were not made for want of room.
  void report(NodeReport& report) override;
  void save(const StateWriter& to) const override;
  void restore(const StateReader& from) override;
  std::int64_t particleCount() const override;

  ParticleSet& owned() override { return *set_; }
  const Slabs* slabs() const override { return shared_ ? &shared_->particles.slabs() : nullptr; }
  void watch(bool watched) override { watched_ = watched; }
  Value ranksReport() const override;

 private:
  /// How many there are.
  struct Tally {
    std::int64_t particles = 0;
    Vec3i kinds;  // spray, foam, bubbles
  };
  /// How many a step makes. On several ranks, those of each come in their order.
  struct Births {
    std::int64_t wanted = 0;  // by all ranks
    std::int64_t made = 0;    // of these
    std::int64_t before = 0;  // wanted by the ranks before this one
    std::int64_t own = 0;     // wanted by this one

    /// The first one made of those from the given number of wanted ones on.
    std::int64_t firstMade(std::int64_t number) const {
      return made == wanted ? number : (number * made + wanted - 1) / wanted;
    }
  };
  /// What ranks that share the particles have.
  struct Shared {
    Shared(Communicator& ranks, ParticleSet& set, float cellSize)
        : particles(ranks, set, cellSize), fluid(particles.ranks(), set.device()), ahead(set.device()) {}
    DividedParticles particles;
    RemoteFluid fluid;
    Array<Vec3f> ahead;                   // where a step takes them, m
    std::optional<ParticleSet> gathered;  // on rank 0, if somebody looks
    Tally tally;                          // of all ranks, at the last frame
    Value report = Value::object();
    std::int64_t stepsTimed = 0;  // since the reset
  };
  /// What kernels find of the fluid's particles, by their order in the fluid; scratch.
  struct Sources {
    explicit Sources(Device& device)
        : fast(device), normals(device), filled(device), born(device), before(device) {}
    Array<std::uint8_t> fast;  // of each cell of the grid: whether fluid in it is fast enough
    Array<Vec3f> normals;      // by place in the grid; 0 within fluid and at walls
    Array<float> filled;
    Array<int> born, before;  // how many each makes, and all before it; one more than particles
  };

  WhiteParticles elements();
  /// Of the particles born next, `count` of them.
  void makeRoomForBorn(std::int64_t count);
  void limitReached(Log& log);
  /// The fluid; on several ranks, what this one has of it.
  Particles presentFluid() const;
  /// The node above, as ranks see it.
  OwnedParticles& sharedFluid() const;
  Tally tallyOwn();
  bool isWatched() const;
  /// What is looked at: all particles, where this rank has gathered them.
  ParticleSet& shown() { return shared_ && shared_->gathered ? *shared_->gathered : *set_; }
  void share(Device& device);
  void lookOnRanks();
  void gatherAll();
  void sumRemoved();
  /// Bytes on the device for as many, and for what is found of so many particles of the fluid.
  double memoryOfOwn(double particles) const;
  static double memoryOfSources(double fluid);
  double memoryOnRanks(Device& device) const;
  double memoryOfGathered() const;
  /// The step of its own that ends with this one of the fluid, if one does.
  std::optional<StepContext> ownStep(const StepContext& context);
  template <class Backend>
  void stepOn(Backend& device, const StepContext& context);
  /// On several ranks: all go to where the step will take them, and the fluid near there comes.
  template <class Backend>
  void migrateOn(Backend& device, const StepContext& context);
  Births birthsOfAll(std::int64_t own);
  template <class Backend>
  void advanceOn(Backend& device, const StepContext& context);
  template <class Backend>
  void sortAliveOn(Backend& device);
  template <class Backend>
  void countBornOn(Backend& device, const Particles& of, const StepContext& context);
  template <class Backend>
  void findNormalsOn(Backend& device);
  template <class Backend>
  void bearOn(Backend& device, const Particles& of, const StepContext& context, const Births& births);
  template <class Backend>
  void countKindsOn(Backend& device, Vec3i* counts);

  std::optional<ParticleSet> set_;
  Attribute<int> kind_;
  Attribute<float> age_, left_, radius_;
  std::optional<FluidGrid> grid_;
  std::optional<Sources> sources_;
  std::optional<WallsOfFluid> walls_;
  std::optional<CellSort> order_;  // by the cells of the grid, so that neighbours read the same fluid
  ParticleBatch born_;
  std::uint64_t seed_ = 0;
  bool warned_ = false;
  Communicator* ranks_ = nullptr;
  bool watched_ = true;
  std::unique_ptr<Shared> shared_;         // on several ranks, from the reset on
  State<double> waited_{*this, "waited"};  // since its last step, s
  State<std::int64_t> steps_{*this, "steps"}, made_{*this, "made"}, refused_{*this, "refused"};
  State<Array<int>> removed_{*this, "removed"};                 // by sinks; one number
  State<std::int64_t> removedBefore_{*this, "removed_before"};  // by all ranks, which that has not
  State<Array<Pose>> poses_{*this, "poses"};                    // of the solids, see WallsOfFluid
};

}  // namespace weir
