// --ply-particles DIR: each frame's particles as PLY files, one for each node that puts out
// Particles: water_00012.ply.
//
// The points have x, y, z and vx, vy, vz, as the node ParticleFile reads them back, and all other attributes
// of the particles; vectors are three properties, with _x, _y and _z behind the attribute's name.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/particles/particles.h"
#include "framework/run/output_kind.h"
#include "plugins/mesh_export/frame_files.h"

namespace weir {

class ParticleSequence final : public Observer {
 public:
  explicit ParticleSequence(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::string name() const override { return "particle files"; }
  std::string_view stateName() const override { return "particle_files"; }
  /// Throws an io Error if the scene has no particles, or the folder cannot be used.
  void begin(Simulation& simulation) override;
  void resume(Simulation& simulation, const StateReader&) override { begin(simulation); }
  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override;
  void write(Snapshot& snapshot) override;
  void end(Simulation&, RunEnd) override {}

 private:
  struct Source {
    std::string node;
    const Output<Particles>* output;
  };
  class Frame;

  std::filesystem::path folder_;
  std::vector<Source> sources_;
  std::optional<FrameFiles> files_;
};

class ParticleSequenceKind final : public OutputKind {
 public:
  std::vector<OutputOption> options() const override;
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override;
};

}  // namespace weir
