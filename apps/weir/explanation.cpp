#include "apps/weir/explanation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <vector>

#include "apps/weir/describe.h"
#include "framework/base/text.h"
#include "framework/run/progress.h"

namespace weir::app {

namespace {

/// "a, b and c"; of many, the first ones and how many more.
std::string shortList(std::vector<std::string> names) {
  constexpr std::size_t kMaxShown = 8;
  if (names.size() > kMaxShown) {
    const std::size_t more = names.size() - kMaxShown + 1;
    names.resize(kMaxShown - 1);
    names.push_back(fmt::format("{} more", more));
  }
  return joinNames(names, " and ");
}

/// As the second half of a sentence.
std::string continued(std::string text) {
  const bool isAcronym = text.size() > 1 && std::isupper(static_cast<unsigned char>(text[1])) != 0;
  if (!text.empty() && !isAcronym)
    text.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(text.front())));
  return text;
}

std::string counted(std::int64_t count, const std::string& what) {
  return groupedText(count) + " " + what + (count == 1 ? "" : "s");
}

std::string equalSteps(const Clock& clock) {
  return fmt::format("Each frame takes {} of {:.3g} ms; that is {} in all.",
                     counted(clock.stepsAfterFrame(0), "step"), 1e3 * clock.dtAfterFrame(0),
                     counted(clock.totalSteps(), "step"));
}

}  // namespace

std::string explainTime(const Simulation& simulation) {
  const World& world = simulation.scene().world;
  const Clock& clock = simulation.clock();
  std::string text = fmt::format("It simulates {:.6g} s in {}, {:.6g} a second. ", world.duration.get(),
                                 counted(clock.frameCount(), "frame"), world.frameRate.get());
  if (world.duration.get() == 0) return text + "There are no steps.";
  if (!simulation.stepsVary()) return text + equalSteps(clock);
  // Steps that vary are no longer than those of the clock, and end at the same frames.
  return text + fmt::format(
                    "Steps follow the fastest particles and take at most {:.3g} ms, so there are at least "
                    "{}.",
                    1e3 * simulation.longestStep(), groupedText(clock.totalSteps()));
}

std::string explainNodes(const SceneGraph& graph) {
  std::vector<const Node*> firsts;  // of each type, in the order of the scene
  std::map<std::string_view, std::vector<std::string>> names;
  for (const auto& node : graph.nodes()) {
    std::vector<std::string>& ofType = names[node->info().type];
    if (ofType.empty()) firsts.push_back(node.get());
    ofType.push_back(node->name());
  }
  std::string text;
  for (const Node* node : firsts)
    text += "  " +
            wrapped(fmt::format("{} ({}): {}", shortList(names[node->info().type]), node->info().type,
                                continued(std::string(node->info().doc))),
                    6) +
            "\n";
  return text;
}

std::string explainLinks(const SceneGraph& graph) {
  std::string text;
  for (const auto& node : graph.nodes())
    for (const InputPort* input : node->inputs()) {
      std::vector<std::string> sources;
      for (const OutputPort* output : input->links()) sources.push_back(output->node().name());
      if (sources.empty()) continue;
      text += "  " +
              wrapped(fmt::format("{} -> {}: {}", shortList(std::move(sources)), input->path(),
                                  continued(input->doc())),
                      6) +
              "\n";
    }
  return text;
}

std::string explainMemory(const MemoryEstimate& estimate, const std::string& device, double available) {
  std::vector<MemoryEstimate::Entry> entries = estimate.entries();
  std::stable_sort(entries.begin(), entries.end(),
                   [](const auto& a, const auto& b) { return a.needs.device > b.needs.device; });
  std::vector<std::string> largest;
  for (std::size_t i = 0; i < entries.size() && i < 3; ++i)
    largest.push_back(shortBytes(entries[i].needs.device) + " for " + entries[i].node);
  std::string text = fmt::format("Memory: at most {} on {}", shortBytes(estimate.total().device), device);
  if (available > 0) text += fmt::format(", where {} are free", shortBytes(available));
  return text + (largest.size() > 1 ? "; " + joinNames(largest, ", ") : "") + ".";
}

}  // namespace weir::app
