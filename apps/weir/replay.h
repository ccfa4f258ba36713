// Shows a recording in its scene: puts the particles of each recorded frame into the scene's fluids. Nodes
// that follow recordings (Node::followsRecordings), and are not in it themselves, are made anew of its
// frames.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "framework/particles/particles.h"
#include "framework/run/simulation.h"
#include "nodes/particle_file/recording.h"

namespace weir::app {

class Replay {
 public:
  /// Makes the simulation a replay (Simulation::replay). Both must outlive it. Throws an io Error if the
  /// recording has fluids that the scene does not have.
  Replay(Simulation& simulation, const Recording& recording);

  /// Shows this frame alone. Throws a usage Error if the recording has none of that number.
  void showOnly(std::int64_t frame);
  /// The next frame; false if there is none. Throws an io Error for what cannot be read.
  bool next();

  /// The names of the fluids that it shows, in the order in which the recording has them.
  const std::vector<std::string>& fluids() const { return names_; }
  std::int64_t shown() const { return static_cast<std::int64_t>(frame_ - first_); }  ///< frames so far
  std::int64_t particles() const { return particles_; }                              ///< of the present frame
  std::int64_t lastFrame() const { return static_cast<std::int64_t>(end_) - 1; }

 private:
  struct Target {
    Output<Particles>* output;
    /// Of recorded attributes alone, so that nothing else can be looked at.
    std::unique_ptr<ParticleSet> particles;
  };

  void fill(Target& target, const RecordedFluid& from) const;
  void findFollowers();
  void load();

  Simulation& simulation_;
  const Recording& recording_;
  std::vector<Target> targets_;
  std::vector<std::string> names_;
  std::vector<Node*> followers_;             // which go on as the frames of the recording do
  std::size_t loaded_ = 0;                   // frames so far
  std::size_t first_ = 0, frame_ = 0, end_;  // the next one, and which are shown
  std::int64_t particles_ = 0;
};

}  // namespace weir::app
