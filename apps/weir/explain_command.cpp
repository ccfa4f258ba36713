#include "apps/weir/explain_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>

#include "apps/weir/describe.h"
#include "apps/weir/explanation.h"
#include "apps/weir/installed_scenes.h"
#include "apps/weir/standard_streams.h"
#include "framework/base/interruption.h"
#include "framework/base/text.h"
#include "framework/run/progress.h"
#include "framework/run/run.h"

namespace weir::app {

namespace {

constexpr int kMaxThreads = 1024;
constexpr double kMaxPrepared = 3e6;  // particles
constexpr double kMeasuredSeconds = 5;

using WallClock = std::chrono::steady_clock;

void tell(const std::string& sentences) {
  print(wrapped(sentences, 0) + "\n");
}

/// Runs until Ctrl-C or for some seconds; how many particles there were at the start.
std::int64_t runForSeconds(Simulation& simulation) {
  const Interruption interruption;
  std::atomic<bool> stop = false;
  std::int64_t atStart = 0;
  std::optional<WallClock::time_point> start;
  RunOptions options;
  options.stop = &stop;
  options.onProgress = [&](const Simulation&) {
    if (!start) start = WallClock::now(), atStart = simulation.particleCount();
    const double passed = std::chrono::duration<double>(WallClock::now() - *start).count();
    if (passed > kMeasuredSeconds || interruption.asked()) stop = true;
  };
  runSimulation(simulation, {}, options);
  if (interruption.asked()) throw Interrupted();
  return atStart;
}

/// What the steps so far tell of the whole run.
std::string timeOf(const Simulation& simulation, double maxParticles) {
  if (simulation.stepsDone() == 0) return "Time: there are no steps to measure.";
  const auto done = static_cast<double>(simulation.stepsDone());
  const double perStep = simulation.stepSeconds() / done;
  const double steps = simulation.stepsVary()
                           ? done * simulation.scene().world.duration.get() / simulation.time()
                           : static_cast<double>(simulation.clock().totalSteps());
  std::string text = fmt::format(
      "Time: {} steps took {:.3g} ms each, with {} particles. {} like these take {} without outputs",
      groupedText(simulation.stepsDone()), 1e3 * perStep, groupedText(simulation.particleCount()),
      groupedText(std::llround(steps)), durationText(steps * perStep));
  constexpr double kNoticeable = 1.1;
  const double growth = maxParticles / std::max(static_cast<double>(simulation.particleCount()), 1.0);
  if (growth > kNoticeable)
    text += fmt::format("; they grow longer with up to {:.2g} times the particles", growth);
  return text + ".";
}

}  // namespace

ExplainCommand::ExplainCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand(
          "explain", "Tell what a scene will do: what flows where, particles, memory, steps, warnings")) {
  command_->add_option("scene", scene_, kSceneHelp)->required()->type_name("SCENE");
  command_->add_option("--set", set_, "Change a parameter first, as for 'weir run'")
      ->type_name("NAME=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  command_->add_flag("--measure", measure_,
                     "Run the first steps for some seconds, to tell how long a run takes");
  command_->add_option("--device", device_, "auto, cpu, cuda or cuda:N")
      ->type_name("D")
      ->capture_default_str();
  command_->add_option("--threads", threads_, "Threads on the CPU; one a core if it is left out")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxThreads));
  program_.addPluginOption(*command_);
  program_.addPluginPermission(*command_);
}

std::unique_ptr<Scene> ExplainCommand::loadedScene() {
  std::vector<Override> overrides;
  for (const std::string& text : set_) overrides.push_back(parseOverride(text));
  return loadScene(scene_, program_.registry(), overrides, warnings_, program_.pluginLoader(scene_));
}

void ExplainCommand::tellAmounts(Simulation& simulation) {
  const Device& device = simulation.device();
  const MemoryEstimate estimate = simulation.estimate();
  const double max = estimate.total().particles;
  tell("\n" + explainMemory(estimate, device.name(), static_cast<double>(device.availableMemory())));
  const std::string atMost = groupedText(std::llround(max));
  std::string time = "Time: --measure runs the first steps to tell it.";
  if (measure_) {
    const std::int64_t atStart = runForSeconds(simulation);
    tell(fmt::format("Particles: {} at the start, at most {}.", groupedText(atStart), atMost));
    time = timeOf(simulation, max);
  } else if (max <= kMaxPrepared) {
    simulation.prepare();
    tell(fmt::format("Particles: {} at the start, at most {}.", groupedText(simulation.particleCount()),
                     atMost));
  } else {
    tell(fmt::format("Particles: at most {}.", atMost));
    warnings_.push_back("at this number of particles, settings are checked by --measure or 'weir run' only");
  }
  tell(time);
}

void ExplainCommand::tellWarnings() const {
  print(warnings_.empty() ? "\nThere are no warnings.\n" : "\nWarnings:\n");
  for (const std::string& warning : warnings_) print("  " + wrapped(warning, 4) + "\n");
}

int ExplainCommand::run() {
  scene_ = sceneFile(scene_);
  std::unique_ptr<Scene> scene = loadedScene();
  const std::unique_ptr<Device> device = openDevice(device_, threads_);
  Log log([this](LogLevel level, std::string_view text) {
    if (level >= LogLevel::kWarning) warnings_.emplace_back(text);
  });
  const std::string title = scene->title;
  Simulation simulation(std::move(scene), *device, log, program_.registry());
  const SceneGraph& graph = simulation.scene().graph;
  if (!title.empty()) tell(printable(title, 300));
  tell(explainTime(simulation));
  print("\nNodes:\n" + explainNodes(graph));
  if (!graph.links().empty()) print("\nWhat flows where:\n" + explainLinks(graph));
  tellAmounts(simulation);
  tellWarnings();
  return kDone;
}

}  // namespace weir::app
