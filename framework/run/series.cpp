#include "framework/run/series.h"

#include "framework/base/file_output.h"
#include "framework/run/statistics.h"
#include "framework/scene/scene_file.h"

namespace weir {

void SeriesOutput::begin(Simulation&) {
  checkWritable(file_);
  lines_.clear();
}

std::unique_ptr<Snapshot> SeriesOutput::capture(Simulation& simulation, std::unique_ptr<Snapshot>) {
  lines_ += writeJsonLine(frameStatistics(simulation));
  return nullptr;
}

void SeriesOutput::save(const StateWriter& to) {
  to.put("lines", std::span<const char>(lines_));
}

void SeriesOutput::resume(Simulation& simulation, const StateReader& from) {
  begin(simulation);
  const std::vector<char> lines = from.getAll<char>("lines");
  lines_.assign(lines.begin(), lines.end());
}

void SeriesOutput::end(Simulation&, RunEnd) {
  writeFileAtomically(file_, lines_);
}

}  // namespace weir
