// What the modules of a fluid work on. A module of one's own derives from FluidModule:
//
//   class Vortex : public FluidModule {
//    public:
//     static constexpr ModuleInfo kInfo{"Vortex", kFamily, "Swirls the fluid about the y axis."};
//     const ModuleInfo& info() const override { return kInfo; }
//     void step(FluidStep& fluid) override;
//   };
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/memory_estimate.h"
#include "framework/graph/module.h"
#include "framework/graph/node.h"
#include "framework/graph/state.h"
#include "framework/neighbors/neighbor_list.h"
#include "framework/particles/particle_set.h"
#include "nodes/particle_fluid/fluid_constants.h"

namespace WEIR_API weir {

struct Boundary;
class DividedParticles;
class PeriodicImages;
struct FluidStep;
struct WallField;

/// The role of the module that finds what a fluid feels of solids, beside its step wherever the positions of
/// a step or of a frame need it. The first enabled module of the pipeline that has it is asked.
class WallFinder {
 public:
  /// Fills fluid.walls, which has solids, for the present positions and the solids as walls.views says.
  virtual void findWalls(FluidStep& fluid) = 0;

 protected:
  ~WallFinder() = default;
};

/// The role of modules that work in a periodic domain, for those that have not the role OnRanks, which do so,
/// too: they call FluidStep::exchange as is told there. All others are refused in such a domain.
class InPeriodicDomain {
 public:
  virtual ~InPeriodicDomain() = default;
};

/// The state of a fluid within one step. Between the modules `predict` and the solver, positions are
/// predicted ones; before and after, they are those of the beginning and the end of the step.
struct FluidStep {
  const StepContext& time;
  Device& device;
  const FluidConstants& constants;
  ParticleSet& particles;
  NeighborList& neighbors;
  const std::vector<const Boundary*>& boundaries;
  Aabb domain;                          ///< particles outside are removed
  ArrayView<const SinkPiece> sinks;     ///< particles inside are removed; on the device
  WallField& walls;                     ///< what rigid meshes do; empty where there are none
  WallFinder* wallFinder = nullptr;     ///< there wherever the fluid meets solids
  DividedParticles* divided = nullptr;  ///< there where several ranks share the particles
  PeriodicImages* images = nullptr;     ///< there where the domain is periodic

  /// Sorts the particles and lists the neighbours of each.
  void findNeighbors();
  /// Before kernels read these attributes of neighbours, once they have been written: brings what is known of
  /// other ranks' particles, and of images beyond the faces of a periodic domain, up to date. Without these
  /// there is nothing to do.
  void exchange(std::initializer_list<std::string_view> attributes);
  /// The same for scratch memory by particle. Of four numbers, the first three are a position.
  void exchange(ArrayView<float> values);
  void exchange(ArrayView<Vec3f> values);
  void exchange(ArrayView<Vec4f> values);
  /// Brings `walls` up to date with the present positions.
  void findWalls();
};

/// What is known of a fluid's run before its first step, for warnings.
struct FluidOutlook {
  const FluidConstants& constants;
  double dt;        ///< the longest step, s
  double pressure;  ///< at the bottom of the fluid that is there at first, once it rests: ρ0·|g|·h, Pa
  Log& log;
  std::string node;  ///< its name

  /// A warning of a setting of a module, worded as warnOfSetting does it.
  void warn(const Module& module, const std::string& found, const std::string& better) const;
};

/// What arrays will have to hold.
struct FluidRoom {
  double particles = 0;
  int solids = 0;               ///< that the fluid meets
  bool wallShares = false;      ///< whether solvers follow what walls do to each particle
  bool boundaryForces = false;  ///< whether boundaries report forces
};

/// What a module keeps between steps is either a State member or an attribute of the particles.
class FluidModule : public Module {
 public:
  static constexpr std::string_view kFamily = "FluidModule";

  /// Before steps that bring fluid to rest, and again at time 0: adds attributes, zeroes sums, checks.
  virtual void reset(FluidStep&) {}
  /// Warns of parameters that are known to be unstable or not enough, with the number that says so. Called
  /// after reset, of modules that are enabled.
  virtual void warn(const FluidOutlook&) const {}
  virtual void step(FluidStep& fluid) = 0;
  /// Bytes that it will hold on the device, with its attributes of the particles (see memory_estimate.h).
  virtual double memory(const FluidRoom&) const { return 0; }
  virtual void report(NodeReport&) {}
};

}  // namespace weir
