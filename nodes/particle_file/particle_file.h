// Particles from a file, such as another program's samples or the last frame of an earlier export.
//
// Which reader a file gets is decided by its ending: .csv and .ply are built in, plugins bring more (see
// particle_reader.h). A particle at p with velocity v in the file gets position + R·(scale·p) and
// R·(scale·v), where R is the rotation: `scale` is the length of the file's unit in metres. Attributes stay
// as they are, vectors too. In a fluid that has no other source, a particle's id is its row in the file, from
// 0. A program may give the particles in place of a file.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/graph/given_data.h"
#include "framework/graph/node.h"
#include "framework/particles/particle_batch.h"
#include "nodes/particle_file/particle_reader.h"

namespace WEIR_API weir {

class ParticleFile final : public Node, public OnRanks, public GivenData {
 public:
  static constexpr NodeInfo kInfo{"ParticleFile", "Particles from a file: .csv, .ply, .vtkhdf and others.",
                                  "import, load, csv, ply, point cloud, restart, initial"};
  const NodeInfo& info() const override { return kInfo; }

  Param<FilePath> file{*this, "file", {}, {.doc = "The file; its ending says what it is."}};
  Param<std::optional<double>> time{
      *this,
      "time",
      std::nullopt,
      {.unit = "s",
       .doc =
           "Of a file with several moments, such as an export, the one nearest to this time; the last one if "
           "it is left out."}};
  Param<std::vector<std::string>> attributes{
      *this,
      "attributes",
      {},
      {.doc = "What else of a .ply file the particles keep, by name: a property of numbers, or three float "
              "properties NAME_x, NAME_y and NAME_z as the vector NAME."}};
  Param<Vec3f> position{*this, "position", {}, {.unit = "m", .doc = "Where the file's origin comes to be."}};
  Param<float> scale{*this,
                     "scale",
                     1,
                     {.min = 0,
                      .aboveMin = true,
                      .doc = "Multiplies positions and velocities; 0.001 for a file in millimetres."}};
  Param<Rotation> rotation{
      *this, "rotation", {}, {.unit = "degrees", .doc = "Turns the particles about the file's origin."}};

  Output<ParticleBatch> particles{*this, "particles",
                                  "The particles. A fluid takes them as initial ones, or as emitted ones in "
                                  "its first step."};

  /// Takes these particles in place of a file's, until a file is named again: finite ones, with all their
  /// columns as attributes.
  void give(ParticleData data);
  /// Those, or null if there is a file.
  const ParticleData* given() const { return given_ && file->empty() ? &*given_ : nullptr; }
  std::optional<std::uint32_t> givenDigest() const override;

  void validate() const override;
  void estimate(const SetupContext& context, MemoryNeeds& needs) override;
  void reset(const SetupContext& context) override;
  void step(const StepContext& context) override;
  void report(NodeReport& report) override;

 private:
  ParticleData read(const Registry& registry) const;
  ParticleData readFile(const Registry& registry) const;
  /// Keeps the columns that are asked for.
  void choose(ParticleData& data) const;
  ParticleData readWith(const ParticleReader& reader) const;

  std::optional<ParticleData> given_;
  std::optional<ParticleData> read_;  // by estimate(), for reset()
  std::int64_t count_ = 0;
};

}  // namespace weir
