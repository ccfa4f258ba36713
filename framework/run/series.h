// What --series writes: numbers of every frame, for plots of how a run went.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/growing_file.h"
#include "framework/run/observer.h"

namespace WEIR_API weir {

/// Writes one JSON object a line for each frame, frame 0 included (JSON Lines): see frameStatistics. To a
/// file that ends in .csv it writes a table, with a line a frame and a column for each number, in the order
/// in which they were met first: columns are the paths of numbers ("water.linear_momentum.x"). A column
/// "ms_per_step" has what a step took since the frame before.
///
/// The file stands from frame 0 on and grows with each frame, so that it can be read while the run goes on;
/// nothing of it is kept in memory. It has all frames that were reached, however the run ends.
class SeriesOutput final : public Observer {
 public:
  explicit SeriesOutput(std::filesystem::path file);
  ~SeriesOutput() override;

  std::string name() const override { return "series"; }
  void begin(Simulation& simulation) override;
  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override;
  void end(Simulation& simulation, RunEnd how) override;
  std::string_view stateName() const override { return "series"; }
  void save(const StateWriter& to) override;
  /// Throws an io Error if the file is not as it was at the checkpoint, or longer.
  void resume(Simulation& simulation, const StateReader& from) override;

 private:
  class Table;

  void addLine(const Value& frame);
  void addRow(const Value& frame);

  std::filesystem::path file_;
  std::optional<GrowingFile> lines_;  // from frame 0 on
  std::unique_ptr<Table> table_;      // if the file is one
};

}  // namespace weir
