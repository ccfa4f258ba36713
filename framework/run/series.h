// What --series writes: numbers of every frame, for plots of how a run went.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "framework/base/api.h"
#include "framework/run/observer.h"

namespace WEIR_API weir {

/// Writes one JSON object a line for each frame, frame 0 included (JSON Lines): see frameStatistics. To a
/// file that ends in .csv it writes a table, with a line a frame and a column for each number: see tableOf.
/// The file appears, whole, when the run ends, also if it was interrupted or failed: then with the frames it
/// reached.
class SeriesOutput final : public Observer {
 public:
  explicit SeriesOutput(std::filesystem::path file) : file_(std::move(file)) {}

  std::string name() const override { return "series"; }
  void begin(Simulation& simulation) override;
  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override;
  void end(Simulation& simulation, RunEnd how) override;
  std::string_view stateName() const override { return "series"; }
  void save(const StateWriter& to) override;
  void resume(Simulation& simulation, const StateReader& from) override;

 private:
  std::filesystem::path file_;
  std::string lines_;
};

/// Lines of comma-separated values, the first of which names the columns: those of the numbers in JSON Lines,
/// by their paths, "water.compression.mean"; those of vectors as "water.linear_momentum.x" and so on. Texts,
/// longer lists and the list of rare events are left out; a frame without one of the numbers has an empty
/// field. Beside these there is "ms_per_step", of the steps since the line before.
std::string tableOf(std::string_view jsonLines);

}  // namespace weir
