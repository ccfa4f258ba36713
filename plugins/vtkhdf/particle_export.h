// --export FILE.vtkhdf: writes the particles of all fluids, and of all other nodes with Particles, of a
// scene, frame by frame, to one file, or to one for each rank that stand as one (export_of_ranks.h).
//
// Its PointData holds every attribute of the particles: velocity, density, id, and what modules and plugins
// add. If the scene has several fluids, it holds those of all of them, NaN or -1 where a fluid has none, and
// a number that says which fluid a particle belongs to. Ids count within one fluid. The scene's section
// "export" may choose attributes, frames and precision (export_settings.h). The FieldData has the number of
// particles and their spacing [m], the smallest of all fluids. The group /simulation, which readers of VTKHDF
// ignore, keeps the version of Weir, the scene's text, the names of the fluids, and how the run went.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/particles/owned_particles.h"
#include "framework/particles/particles.h"
#include "framework/run/output_by_ranks.h"
#include "plugins/vtkhdf/export_file.h"
#include "plugins/vtkhdf/export_of_ranks.h"
#include "plugins/vtkhdf/export_settings.h"

namespace weir {

/// The attribute that tells fluids apart: 0 for the first name in /simulation/fluids, and so on.
inline constexpr const char* kFluidIndexName = "fluid_index";

/// The file is made with frame 0, when all modules have added their attributes; until then a file that stands
/// there is left as it is.
class ParticleExport final : public Observer {
 public:
  explicit ParticleExport(std::filesystem::path file);
  /// Every rank makes one, for the particles that it owns.
  ParticleExport(std::filesystem::path file, Communicator& ranks);
  ~ParticleExport() override;

  std::string name() const override { return "export"; }
  /// Throws an io Error if the scene has no particles or the file cannot be written.
  void begin(Simulation& simulation) override;
  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override;
  /// Throws an io Error if the frame cannot be written. The frames before it stay readable.
  void write(Snapshot& snapshot) override;
  void end(Simulation& simulation, RunEnd how) override;
  std::string_view stateName() const override { return "vtkhdf"; }
  void save(const StateWriter& to) override;
  void resume(Simulation& simulation, const StateReader& from) override;

 private:
  struct Source {
    std::string name;  ///< the node's
    const Output<Particles>* output;
    OwnedParticles* owned;  ///< null where the node has all that are wanted
    ParticleSet& particles() const { return owned != nullptr ? owned->owned() : (*output)->set(); }
  };
  class Frame;

  const ExportSettings& settings() const { return settings_ != nullptr ? *settings_ : defaults_; }

  bool several() const { return sources_.size() > 1; }
  bool isColumn(std::string_view name) const;

  void findSources(Simulation& simulation);
  // At frame 0.
  void chooseSources();
  void chooseColumns(const Simulation& simulation);
  void checkAttributes() const;
  bool isWanted(const std::string& attribute) const;
  // At every frame.
  void warnOfNewAttributes(const Simulation& simulation) const;
  void warnOfMissing(const Simulation& simulation, const std::string& attribute, const std::string& fluid,
                     const std::string& reason) const;
  VtkHdfLayout layout() const;
  ExportTexts texts() const;
  void openFile();
  void prepareRanks();
  void endOnRanks(Simulation& simulation, RunEnd how);
  /// How many particles of a source this rank writes. What ranks do not share is written by the first one.
  std::int64_t countOf(const Source& source) const;

  /// The scene's, or null where the plugin's section is not known.
  const ExportSettings* settings_ = nullptr;
  const ExportSettings defaults_;
  std::optional<ExportOfRanks> ranks_;
  ExportFile file_;        // the named one, or this rank's
  std::string runText_;    // of the files of ranks, see kRunText
  bool prepared_ = false;  // they are
  std::atomic<std::int64_t> written_ = 0;
  std::vector<Source> sources_;
  std::vector<AttributeInfo> columns_;  // but the position; chosen before the first frame is written
  bool chosen_ = false;
  std::optional<std::vector<std::string>> earlierAttributes_;  // of the file, where a run is resumed
};

class ParticleExportKind final : public OutputKind, public OutputByRanks {
 public:
  std::vector<OutputOption> options() const override;
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override;
  bool isAsked(const Scene& scene) const override;
  std::unique_ptr<Observer> create(const OutputPaths& paths, Communicator& ranks) const override;
};

}  // namespace weir
