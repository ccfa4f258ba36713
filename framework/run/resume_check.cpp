#include "framework/run/resume_check.h"

#include <fmt/format.h>

#include <atomic>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

void advance(Simulation& simulation, std::int64_t frames) {
  const std::atomic<bool> never = false;
  for (std::int64_t i = 0; i < frames; ++i) simulation.advanceFrame(never);
}

/// What nodes and modules say of themselves, as text, because NaN differs from itself.
void putReports(Simulation& simulation, const StateWriter& to) {
  for (Node* node : simulation.scene().graph.order()) {
    NodeReport report;
    node->report(report);
    for (const RareEvent& event : report.events) report.statistics[event.what] = event.count;
    for (const auto& [name, value] : report.statistics.asObject())
      detail::putState(to.in(node->name()), name, writeJson(value));
  }
}

/// All that is compared, without the seconds that it took.
StateArrays seenOf(Simulation& simulation, const ResumeCheck& check) {
  StateArrays all;
  const StateWriter to(all);
  simulation.save(to.in("state"));
  all.erase("state/clock/step_seconds");
  all.erase("state/clock/wall_seconds");
  putReports(simulation, to.in("report"));
  if (check.observe) check.observe(simulation, to.in("seen"));
  return all;
}

std::string shown(const StateArray& array) {
  const std::string_view text(reinterpret_cast<const char*>(array.data.data()), array.data.size());
  return fmt::format("{} rows{}", array.rows,
                     array.kind == StateKind::kByte ? ", " + printable(std::string(text), 60) : "");
}

std::vector<std::string> compare(const StateArrays& whole, const StateArrays& resumed, std::int64_t frame) {
  std::vector<std::string> differences;
  const auto add = [&](const std::string& path, const std::string& how) {
    differences.push_back(fmt::format("frame {}: {}{}", frame, path, how));
  };
  for (const auto& [path, array] : whole) {
    const auto other = resumed.find(path);
    if (other == resumed.end())
      add(path, " is missing in the resumed run");
    else if (array.data != other->second.data)
      add(path, fmt::format(": {}; resumed: {}", shown(array), shown(other->second)));
  }
  for (const auto& [path, array] : resumed)
    if (!whole.contains(path)) add(path, " is in the resumed run alone");
  return differences;
}

}  // namespace

std::vector<std::string> resumeDifferences(const std::function<std::unique_ptr<Simulation>()>& make,
                                           const ResumeCheck& check) {
  const std::int64_t last = check.savedAt + check.comparedFor;
  const std::unique_ptr<Simulation> whole = make();
  if (whole->clock().frameCount() < last)
    throw usageError(fmt::format("the scene ends at frame {}", whole->clock().frameCount()),
                     fmt::format("a duration of at least {} frames", last));
  whole->reset();
  advance(*whole, check.savedAt);
  StateArrays saved;
  whole->save(StateWriter(saved));
  const std::unique_ptr<Simulation> resumed = make();
  resumed->resume(StateReader(saved));
  for (std::int64_t frame = check.savedAt + 1; frame <= last; ++frame) {
    advance(*whole, 1);
    advance(*resumed, 1);
    auto differences = compare(seenOf(*whole, check), seenOf(*resumed, check), frame);
    if (!differences.empty()) return differences;
  }
  return {};
}

}  // namespace weir
