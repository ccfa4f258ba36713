#include "apps/weir/render_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "apps/weir/command_line_errors.h"
#include "apps/weir/replay.h"
#include "apps/weir/shown_run.h"
#include "framework/base/interruption.h"
#include "framework/base/text.h"
#include "nodes/particle_file/guarded_recording.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

constexpr int kMaxThreads = 1024;

/// Frames per second of equal distances; nothing where the distances differ, or there is one frame.
std::optional<double> rateOf(const std::vector<double>& times) {
  if (times.size() < 2) return std::nullopt;
  const double mean = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  constexpr double kTolerance = 1e-3;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (std::abs(times[i] - times[i - 1] - mean) > kTolerance * mean) return std::nullopt;
  return 1 / mean;
}

/// A setting of an item of a list of groups, or its default.
Value settingOf(const Value& item, const Configurable& group, std::string_view name) {
  const Value* given = item.find(name);
  if (given != nullptr) return *given;
  const Property* setting = group.findProperty(name);
  return setting != nullptr ? setting->defaultValue() : Value();
}

/// What shows a fluid's numbers in pictures, and which: "render.color.by" and "speed".
struct ShownNumbers {
  std::string setting, by;
};

/// Of its spheres or of its foam. `render` is the section of that name.
ShownNumbers numbersOf(const Configurable& render, const std::string& fluid) {
  const Property* looks = render.findProperty("fluids");
  const Property* color = render.findProperty("color");
  if (looks == nullptr || looks->group() == nullptr || color == nullptr || color->group() == nullptr)
    return {};
  const Value items = looks->value();
  for (std::size_t i = 0; i < items.asArray().size(); ++i) {
    const Value& item = items.asArray()[i];
    if (settingOf(item, *looks->group(), "node").asString() != fluid) continue;
    if (settingOf(item, *looks->group(), "look").asString() != "water") break;
    const Value* foam = item.find("foam");
    const Value* by = foam != nullptr ? foam->find("by") : nullptr;
    return {fmt::format("render.fluids[{}].foam.by", i), by != nullptr ? by->asString() : "none"};
  }
  const Property* by = color->group()->findProperty("by");
  return {"render.color.by", by != nullptr ? by->value().asString() : std::string()};
}

bool hasArrows(const Configurable& render) {
  const Property* arrows = render.findProperty("arrows");
  const Property* spacing =
      arrows != nullptr && arrows->group() != nullptr ? arrows->group()->findProperty("spacing") : nullptr;
  return spacing != nullptr && !spacing->value().isNull();
}

/// Throws an io Error where pictures are to show velocities of a fluid that the file has none of.
void checkVelocities(const Scene& scene, const Recording& recording, const std::vector<std::string>& fluids,
                     const std::string& file) {
  const auto section = scene.sections.find("render");
  if (section == scene.sections.end()) return;
  const Configurable& render = *section->second;
  const Property* particles = render.findProperty("particles");
  if (particles != nullptr && particles->value().asString() == "none") return;
  const std::vector<RecordedFluid> recorded = recording.read(0);
  for (std::size_t i = 0; i < fluids.size(); ++i) {
    std::vector<std::string> names;
    for (const RecordedArray& array : recorded[i].arrays) names.push_back(array.name);
    if (std::find(names.begin(), names.end(), "velocity") != names.end()) continue;
    const ShownNumbers shown = numbersOf(render, fluids[i]);
    const std::string lacking = "the file has no attribute 'velocity' of the fluid " + inQuotes(fluids[i]);
    names.emplace_back("none");
    if (shown.by == "speed" || shown.by == "velocity")
      throw ioError(fmt::format("{}, and {} asks for {}", lacking, shown.setting, inQuotes(shown.by)),
                    joinNames(names))
          .at({.file = file});
    if (hasArrows(render))
      throw ioError(lacking + ", and render.arrows.spacing asks for arrows", "no such spacing")
          .at({.file = file});
  }
}

}  // namespace

RenderCommand::RenderCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand("render",
                                  "Make videos and pictures of an export, without simulating: with another "
                                  "camera, size or colours")) {
  command_->add_option("file", file_, "What --export wrote")->required()->type_name("FILE");
  command_->add_option("--scene", scene_, "The scene of that run; its section render may be another")
      ->required()
      ->type_name("SCENE");
  outputs_ = std::make_unique<OutputOptions>(*command_, program_, true);
  command_->add_option("--frame", frame_, "Show this frame alone")->type_name("N")->check(notNegative());
  addEngineOption(*command_, engine_);
  command_->add_option("--set", set_, "Change a parameter first, such as render.width=1920; may be repeated")
      ->type_name("NAME=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  command_->add_option("--device", device_, "What holds the particles: cpu, cuda or cuda:N")
      ->type_name("D")
      ->capture_default_str();
  program_.addPluginOption(*command_);
  program_.addPluginPermission(*command_);
  command_->add_option("--threads", threads_, "Threads on the CPU; one a core if it is left out")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxThreads));
  command_->add_flag("--quiet", quiet_, "Show warnings and errors only");
}

std::unique_ptr<Recording> RenderCommand::openRecording() const {
  std::vector<std::string> endings;
  const std::string ending = lowerCase(fs::path(file_).extension().string());
  for (const auto& reader : guardedRecordingReaders(program_.registry()))
    for (const std::string& known : reader->extensions()) {
      if (known == ending) return reader->open(file_);
      endings.push_back(known);
    }
  throw usageError(printable(file_, 200) + " is of no known kind",
                   endings.empty() ? "nothing: no plugin that reads exports is loaded"
                                   : "a file that ends in " + joinNames(endings));
}

std::unique_ptr<Scene> RenderCommand::loadScene(const Recording& recording) {
  std::vector<Override> changes;
  for (const std::string& text : set_) changes.push_back(parseOverride(text));
  addEngine(engine_, changes);
  std::unique_ptr<Scene> scene = program_.load(scene_, changes);
  // Videos then take as long as the run did, also where not every frame was exported.
  if (const std::optional<double> rate = rateOf(recording.times()))
    scene->world.frameRate.set(*rate);
  else if (recording.times().size() > 1)
    program_.log().warn(fmt::format("the frames of {} are not at equal distances: videos show {} a second",
                                    printable(file_, 200), scene->world.frameRate.get()));
  return scene;
}

int RenderCommand::run() {
  program_.setQuiet(quiet_);
  if (!outputs_->any())
    throw usageError("nothing is to be made", outputs_->names().empty()
                                                  ? "nothing: no plugin that makes pictures is loaded"
                                                  : outputs_->names());
  TakenPaths taken;
  taken.addInput(file_, "the export");
  taken.addInput(scene_, "the scene");
  outputs_->checkPaths(taken);
  const Interruption interruption;  // before the locks, whose files a signal would leave behind
  const std::vector<OutputLock> locks = taken.lock();
  const std::unique_ptr<Recording> recording = openRecording();
  std::unique_ptr<Scene> scene = loadScene(*recording);
  const std::unique_ptr<Device> device = openDevice(device_, threads_);
  Simulation simulation(std::move(scene), *device, program_.log(), program_.registry());
  std::optional<Replay> replay;
  try {
    replay.emplace(simulation, *recording);
    if (frame_) replay->showOnly(*frame_);
  } catch (Error& error) {
    throw error.at({.file = file_});
  }
  checkVelocities(simulation.scene(), *recording, replay->fluids(), file_);

  RunOptions options;
  options.nextFrame = [&](Simulation&) { return replay->next(); };
  const RunEnd end = runShown(program_, simulation, outputs_->makeObservers(simulation.scene(), nullptr),
                              options, quiet_, [&](const Simulation& s) {
                                ProgressState state = ProgressState::of(s, replay->lastFrame());
                                state.particles = replay->particles();
                                state.endTime = recording->times().back();
                                return state;
                              });
  program_.log().info(
      fmt::format("{}{} frames shown in {}", end == RunEnd::kInterrupted ? "interrupted: " : "",
                  groupedText(replay->shown()), durationText(simulation.secondsSinceReset())));
  outputs_->print();
  return end == RunEnd::kInterrupted ? kInterrupted : kDone;
}

}  // namespace weir::app
