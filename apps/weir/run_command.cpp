#include "apps/weir/run_command.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "apps/weir/interruption.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"
#include "framework/run/progress.h"
#include "framework/run/run.h"
#include "framework/run/series.h"
#include "framework/run/statistics.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

constexpr int kMostThreads = 1024;

std::optional<int> terminalWidth() {
  if (isatty(STDERR_FILENO) == 0) return std::nullopt;
  constexpr int kUsualWidth = 80;
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsualWidth;
}

double monotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Writes --stats, and warns of what must stay rare.
class StatisticsOutput final : public Observer {
 public:
  /// `file` may be empty: then there are only the warnings.
  StatisticsOutput(std::string file, Log& log) : file_(std::move(file)), log_(log) {}

  std::string name() const override { return "statistics"; }
  void begin(Simulation&) override {
    if (!file_.empty()) checkWritable(file_);
  }
  std::unique_ptr<Snapshot> capture(Simulation&, std::unique_ptr<Snapshot>) override { return nullptr; }
  void end(Simulation& simulation, RunEnd how) override {
    const Value statistics = runStatistics(simulation, how);
    for (const std::string& text : rareEventTexts(statistics)) log_.warn(text);
    if (!file_.empty()) writeFileAtomically(file_, writeJson(statistics));
  }

 private:
  std::string file_;
  Log& log_;
};

std::string summaryOf(const Simulation& simulation) {
  const double steps = static_cast<double>(std::max<std::int64_t>(simulation.stepsDone(), 1));
  return fmt::format("{:.3f} s simulated in {} ({} steps of {:.3g} ms each, {} particles at the end)",
                     simulation.time(), durationText(simulation.secondsSinceReset()),
                     groupedText(simulation.stepsDone()), 1e3 * simulation.stepSeconds() / steps,
                     groupedText(simulation.particleCount()));
}

/// "FILE.mp4 or FILE.mkv"
std::string allowedEndings(const OutputOption& option) {
  std::string text;
  for (const std::string& ending : option.extensions) text += (text.empty() ? "" : ", ") + ending;
  return "a file that ends in " + text;
}

void checkPath(const OutputOption& option, const std::string& text) {
  const std::string what = "--" + option.name + " " + printable(text, 200);
  const fs::path path = text;
  if (!option.isFolder()) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    if (std::find(option.extensions.begin(), option.extensions.end(), ending) == option.extensions.end())
      throw usageError(what + (ending.empty() ? " has no ending" : " ends in " + printable(ending)),
                       allowedEndings(option));
  }
  std::error_code error;
  const fs::path above = fs::absolute(path).lexically_normal().parent_path();
  if (!fs::is_directory(above, error))
    throw ioError(what + ": there is no folder " + inQuotes(above.string()),
                  "a path in a folder that exists");
}

}  // namespace

RunCommand::RunCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand("run", "Simulate a scene, and write videos, images and data")) {
  command_->add_option("scene", scene_, "The scene file")->required()->type_name("SCENE");
  command_->add_option("--device", device_, "auto, cpu, cuda or cuda:N")
      ->type_name("D")
      ->capture_default_str();
  command_->add_option("--duration", duration_, "Simulated seconds, in place of the scene's")->type_name("S");
  command_->add_option("--frames", frames_, "End at this frame, if the duration does not end before")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber);
  command_
      ->add_option("--set", set_,
                   "Change a parameter: NODE.PARAM=VALUE, NODE.MODULE.PARAM=VALUE, world.PARAM=VALUE, "
                   "render.PARAM=VALUE or title=TEXT; may be repeated")
      ->type_name("NAME=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  command_->add_option("--plugin", plugin_, "Load this plugin; may be repeated")
      ->type_name("LIB")
      ->take_all()
      ->allow_extra_args(false);
  addOutputOptions();
  command_->add_option("--stats", stats_, "Write numbers about the run: times, memory, momentum, energies, …")
      ->type_name("FILE.json");
  command_
      ->add_option("--series", series_, "Write the same numbers for every frame, as one JSON object a line")
      ->type_name("FILE.jsonl");
  command_
      ->add_option(
          "--checkpoint", checkpoint_,
          "Save the state now and then, so that --resume can go on from there; the last two are kept")
      ->type_name("FILE.h5");
  command_->add_option("--checkpoint-every", checkpointEvery_, "At every so many frames, 20, or seconds, 90s")
      ->type_name("N|Ns")
      ->capture_default_str();
  command_
      ->add_option("--resume", resume_,
                   "Go on from a checkpoint of the same scene; outputs go on behind what they have")
      ->type_name("FILE.h5");
  command_->add_flag("--profile-kernels", profileKernels_, "Time every kernel, not only every module");
  command_->add_flag(
      "--deterministic", deterministic_,
      "Promise that results are bitwise the same from run to run. They always are, so this costs nothing");
  command_->add_option("--threads", threads_, "Threads on the CPU; one a core if it is left out")
      ->type_name("N")
      ->check(CLI::Range(1, kMostThreads));
  command_->add_flag("--quiet", quiet_, "Show warnings and errors only");
}

void RunCommand::addOutputOptions() {
  for (auto& [name, kind] : program_.registry().createServices<OutputKind>()) {
    Output output;
    output.options = kind->options();
    output.paths.resize(output.options.size());
    output.kind = std::move(kind);
    outputs_.push_back(std::move(output));
  }
  // The options write into the outputs, which stay where they are from now on.
  for (Output& output : outputs_)
    for (std::size_t i = 0; i < output.options.size(); ++i)
      command_->add_option("--" + output.options[i].name, output.paths[i], output.options[i].doc)
          ->type_name(output.options[i].argument);
}

std::vector<Override> RunCommand::overrides() const {
  std::vector<Override> all;
  for (const std::string& text : set_) all.push_back(parseOverride(text));
  if (!duration_.empty()) {
    all.push_back(parseOverride("world.duration=" + duration_));
    all.back().value.origin = std::make_shared<const ValueOrigin>(ValueOrigin{"--duration " + duration_, ""});
  }
  return all;
}

void RunCommand::checkOutputPaths() const {
  std::map<std::string, std::string> taken;  // what is written there, by path
  std::error_code error;
  taken[fs::weakly_canonical(scene_, error).string()] = "the scene";
  const auto check = [&](const OutputOption& option, const std::string& text) {
    if (text.empty()) return;
    checkPath(option, text);
    const auto [other, isNew] = taken.emplace(fs::weakly_canonical(text, error).string(), "--" + option.name);
    if (!isNew)
      throw usageError(
          fmt::format("--{} {} would overwrite {}", option.name, printable(text, 200), other->second),
          "a path of its own for each output");
  };
  for (const Output& output : outputs_)
    for (std::size_t i = 0; i < output.options.size(); ++i) check(output.options[i], output.paths[i]);
  check({.name = "checkpoint", .argument = "FILE.h5", .extensions = {".h5"}, .doc = ""}, checkpoint_);
  check({.name = "stats", .argument = "FILE.json", .extensions = {".json"}, .doc = ""}, stats_);
  check({.name = "series", .argument = "FILE.jsonl", .extensions = {".jsonl"}, .doc = ""}, series_);
}

std::vector<std::unique_ptr<Observer>> RunCommand::makeObservers() const {
  std::vector<std::unique_ptr<Observer>> observers;
  for (const Output& output : outputs_) {
    OutputPaths paths;
    for (std::size_t i = 0; i < output.options.size(); ++i)
      if (!output.paths[i].empty()) paths[output.options[i].name] = output.paths[i];
    if (!paths.empty()) observers.push_back(output.kind->create(paths));
  }
  if (!series_.empty()) observers.push_back(std::make_unique<SeriesOutput>(series_));
  observers.push_back(std::make_unique<StatisticsOutput>(stats_, program_.log()));
  return observers;
}

std::unique_ptr<CheckpointStore> RunCommand::checkpointStore(const std::string& option,
                                                             const std::string& path) const {
  std::vector<std::string> endings;
  for (auto& [name, store] : program_.registry().createServices<CheckpointStore>()) {
    endings.emplace_back(store->extension());
    if (fs::path(path).extension() == store->extension()) return std::move(store);
  }
  throw usageError(fmt::format("--{} {} is of no known kind", option, printable(path, 200)),
                   endings.empty() ? "nothing: no plugin that keeps checkpoints is loaded"
                                   : "a file that ends in " + joinNames(endings));
}

std::optional<Checkpoints> RunCommand::makeCheckpoints() const {
  if (checkpoint_.empty()) return std::nullopt;
  return std::make_optional<Checkpoints>(checkpoint_, CheckpointInterval::parse(checkpointEvery_),
                                         checkpointStore("checkpoint", checkpoint_));
}

std::optional<Checkpoint> RunCommand::readCheckpoint(const Simulation& simulation) const {
  if (resume_.empty()) return std::nullopt;
  Checkpoint checkpoint = checkpointStore("resume", resume_)->read(resume_);
  try {
    checkBelongs(checkpoint, simulation);
  } catch (Error& e) {
    throw e.at({.file = resume_});
  }
  return checkpoint;
}

void RunCommand::printResults() const {
  const auto print = [](const std::string& path) {
    if (!path.empty()) fmt::print("{}\n", path);
  };
  for (const Output& output : outputs_)
    for (const std::string& path : output.paths) print(path);
  print(stats_);
  print(series_);
}

int RunCommand::run() {
  program_.setQuiet(quiet_);
  Log& log = program_.log();
  checkOutputPaths();
  auto scene = program_.load(scene_, overrides());
  const std::unique_ptr<Device> device = openDevice(device_, threads_);
  if (deterministic_) device->setDeterministic(true);
  device->profiler().timeKernels(profileKernels_);
  log.info(fmt::format("{} on {}", scene->title.empty() ? scene_ : printable(scene->title, 200),
                       device->description()));
  Simulation simulation(std::move(scene), *device, log, program_.registry());

  const std::optional<Checkpoint> resumed = readCheckpoint(simulation);
  std::optional<Checkpoints> checkpoints = makeCheckpoints();
  const auto observers = makeObservers();
  std::vector<Observer*> watching;
  for (const auto& observer : observers) watching.push_back(observer.get());

  Progress progress([](std::string_view text) { std::fwrite(text.data(), 1, text.size(), stderr); },
                    terminalWidth, monotonicSeconds);
  const Interruption interruption;
  RunOptions options;
  options.lastFrame = frames_;
  options.stop = &interruption.asked();
  if (checkpoints) options.checkpoints = &*checkpoints;
  if (resumed) options.resume = &resumed->state;
  if (!quiet_) {
    program_.beforeMessage([&] { progress.clearLine(); });
    const std::int64_t last = lastFrameOf(simulation.clock(), options);
    options.onProgress = [&, last](const Simulation& s) { progress.update(ProgressState::of(s, last)); };
  }
  RunEnd end = RunEnd::kFailed;
  try {
    end = runSimulation(simulation, watching, options);
  } catch (...) {
    progress.clearLine();
    program_.beforeMessage({});
    throw;
  }
  progress.clearLine();
  program_.beforeMessage({});
  log.info((end == RunEnd::kInterrupted ? "interrupted: " : "") + summaryOf(simulation));
  printResults();
  return end == RunEnd::kInterrupted ? kInterrupted : kDone;
}

}  // namespace weir::app
