#include "apps/weir/run_command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <new>

#include "apps/weir/command_line_errors.h"
#include "apps/weir/installed_scenes.h"
#include "apps/weir/shown_run.h"
#include "apps/weir/standard_streams.h"
#include "framework/base/file_output.h"
#include "framework/base/interruption.h"
#include "framework/base/text.h"
#include "framework/communication/parcel_route.h"
#include "framework/communication/thread_ranks.h"
#include "framework/compute/device_count.h"
#include "framework/run/checkpoints_by_ranks.h"
#include "framework/run/guarded_checkpoint.h"
#include "framework/run/join_ranks.h"
#include "framework/run/output_paths.h"
#include "framework/run/progress.h"
#include "framework/run/run.h"
#include "framework/run/series.h"
#include "framework/run/statistics.h"

namespace weir::app {

namespace fs = std::filesystem;

namespace {

constexpr int kMaxThreads = 1024;
constexpr int kMaxRanks = 256;
constexpr std::string_view kNewest = "auto";  // of --resume

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

std::string hostName() {
  char name[256] = {};  // POSIX allows 255
  return ::gethostname(name, sizeof(name) - 1) == 0 ? printable(name) : "an unknown host";
}

/// How many ranks before this one are on its machine.
int rankHere(Communicator& ranks) {
  const std::string name = hostName();
  const auto* const bytes = reinterpret_cast<const std::byte*>(name.data());
  const std::vector<Message> names = ranks.allGather(Message(bytes, bytes + name.size()));
  const auto own = names.begin() + ranks.rank();
  return static_cast<int>(std::count(names.begin(), own, *own));
}

/// Where parcels have more than one way; otherwise null.
std::unique_ptr<ParcelRoute> openRoute(Communicator* ranks, Device& device, Log& log) {
  auto* const routes = dynamic_cast<ParcelRoutes*>(ranks);
  if (routes == nullptr) return nullptr;
  std::unique_ptr<ParcelRoute> route = routes->openRoute(device);
  if (route) log.info("GPUs of ranks exchange " + route->description());
  return route;
}

/// What all ranks find wrong alike is told by the first one. Returns the exit code.
int tellOfFailedRank(Log& log, const std::exception_ptr& error, int rank) {
  const std::string where = fmt::format("rank {} on {}: ", rank, hostName());
  try {
    std::rethrow_exception(error);
  } catch (const Error& e) {
    const bool ofAll = e.kind() == ErrorKind::kScene || e.kind() == ErrorKind::kUsage;
    if (!ofAll || rank == 0) log.error(ofAll ? e.what() : where + e.what());
    return exitCode(e.kind());
  } catch (const Interrupted&) {
    if (rank == 0) log.info("interrupted before the first step");
    return kInterrupted;
  } catch (const std::bad_alloc&) {
    log.error(where + "out of memory");
  } catch (const std::exception& e) {
    log.error(where + "a mistake in the program, please report it: " + e.what());
  }
  return kSimulationFailed;
}

std::string summaryOf(const Simulation& simulation) {
  const double steps = static_cast<double>(std::max<std::int64_t>(simulation.stepsDone(), 1));
  return fmt::format("{:.3f} s simulated in {} ({} steps of {:.3g} ms each, {} particles at the end)",
                     simulation.time(), durationText(simulation.secondsSinceReset()),
                     groupedText(simulation.stepsDone()), 1e3 * simulation.stepSeconds() / steps,
                     groupedText(simulation.particleCount()));
}

std::string howItEnded(RunEnd end) {
  const int code = exitCodeOf(end);
  return code == kInterrupted ? "interrupted: " : code == kSavedForLater ? "saved, to go on later: " : "";
}

}  // namespace

RunCommand::RunCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand("run", "Simulate a scene, and write videos, images and data")) {
  command_->add_option("scene", scene_, kSceneHelp)->required()->type_name("SCENE");
  command_->add_option("--device", device_, "auto, cpu, cuda or cuda:N")
      ->type_name("D")
      ->capture_default_str();
  command_->add_option("--duration", duration_, "Simulated seconds, in place of the scene's")->type_name("S");
  command_->add_option("--frames", frames_, "End at this frame, if the duration does not end before")
      ->type_name("N")
      ->check(notNegative());
  command_
      ->add_option("--set", set_,
                   "Change a parameter: NODE.PARAM=VALUE, NODE.MODULE.PARAM=VALUE, world.PARAM=VALUE, "
                   "render.PARAM=VALUE, let.NAME=VALUE or title=TEXT; may be repeated")
      ->type_name("NAME=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  program_.addPluginOption(*command_);
  program_.addPluginPermission(*command_);
  addEngineOption(*command_, engine_);
  outputs_ = std::make_unique<OutputOptions>(*command_, program_, false);
  command_->add_option("--stats", stats_, "Write numbers about the run: times, memory, momentum, energies, …")
      ->type_name("FILE.json");
  command_
      ->add_option("--series", series_,
                   "Write the same numbers for every frame: one JSON object a line, or a table (.csv)")
      ->type_name("FILE.jsonl|FILE.csv");
  command_
      ->add_option(
          "--checkpoint", checkpoint_,
          "Save the state now and then, so that --resume can go on from there; the last two are kept")
      ->type_name("FILE.h5");
  command_
      ->add_option("--checkpoint-every", checkpointEvery_,
                   "Interval between checkpoints: frames, 20, or seconds of wall time, 90s")
      ->type_name("N|Ns")
      ->capture_default_str();
  command_
      ->add_option(
          "--resume", resume_,
          "Go on from a checkpoint of the same scene; outputs go on behind what they have. auto: from "
          "the newest whole one of --checkpoint, or from the start where there is none")
      ->type_name("FILE.h5|auto");
  command_->add_flag("--profile-kernels", profileKernels_, "Time every kernel, not only every module");
  command_->add_flag(
      "--deterministic", deterministic_,
      "End the run where results could differ from run to run: if neighbour lists overflow on CUDA");
  command_->add_option("--threads", threads_, "Threads on the CPU; one a core if it is left out")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxThreads));
  command_
      ->add_option("--ranks", ranks_,
                   "Divide the particles among this many ranks, threads on the CPU or, with --device cuda, "
                   "GPUs in turn; the results are the same for any number")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxRanks));
  command_->add_option("--gpus", gpus_, "Divide the particles among this many GPUs: --ranks N --device cuda")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxRanks))
      ->excludes("--ranks")
      ->excludes("--device");
  command_->add_flag("--quiet", quiet_, "Show warnings and errors only");
}

std::vector<Override> RunCommand::overrides() const {
  std::vector<Override> all;
  for (const std::string& text : set_) all.push_back(parseOverride(text));
  if (!duration_.empty()) {
    all.push_back(parseOverride("world.duration=" + duration_));
    all.back().value.origin = std::make_shared<const ValueOrigin>(ValueOrigin{"--duration " + duration_, ""});
  }
  addEngine(engine_, all);
  return all;
}

std::vector<OutputLock> RunCommand::takeOutputPaths() const {
  TakenPaths taken;
  taken.addInput(scene_, "the scene");
  outputs_->checkPaths(taken);
  const auto check = [&](const std::string& name, const std::vector<std::string>& endings,
                         const std::string& path) {
    taken.addOutput({.name = name, .argument = "", .extensions = endings, .doc = ""}, path);
  };
  check("checkpoint", checkpointEndings(), checkpoint_);
  check("stats", {".json"}, stats_);
  check("series", {".jsonl", ".csv"}, series_);
  return taken.lock();
}

std::vector<std::unique_ptr<Observer>> RunCommand::makeObservers(const Scene& scene,
                                                                 Communicator* ranks) const {
  std::vector<std::unique_ptr<Observer>> observers = outputs_->makeObservers(scene, ranks);
  if (ranks != nullptr && ranks->rank() > 0) return observers;
  if (!series_.empty()) observers.push_back(std::make_unique<SeriesOutput>(series_));
  observers.push_back(std::make_unique<StatisticsOutput>(stats_, program_.log()));
  return observers;
}

std::vector<std::string> RunCommand::checkpointEndings() const {
  std::vector<std::string> endings;
  if (checkpoint_.empty()) return endings;
  for (const auto& store : guardedCheckpointStores(program_.registry()))
    endings.emplace_back(store->extension());
  return endings;
}

std::unique_ptr<CheckpointStore> RunCommand::checkpointStore(const std::string& option,
                                                             const std::string& path) const {
  return checkpointStoreOf(program_.registry(), fmt::format("--{} {}", option, printable(path, 200)), path);
}

Checkpoints RunCommand::makeCheckpoints() const {
  return {checkpoint_, CheckpointInterval::parse(checkpointEvery_),
          checkpointStore("checkpoint", checkpoint_)};
}

std::optional<Checkpoint> RunCommand::readCheckpoint(const Simulation& simulation,
                                                     Communicator* ranks) const {
  if (resume_.empty()) return std::nullopt;
  if (resume_ == kNewest)
    return readNewestCheckpoint(*checkpointStore("checkpoint", checkpoint_), checkpoint_, simulation, ranks);
  return weir::readCheckpoint(*checkpointStore("resume", resume_), resume_, simulation, ranks);
}

void RunCommand::printResults() const {
  outputs_->print();
  for (const std::string& path : {stats_, series_})
    if (!path.empty()) print(path + "\n");
}

std::unique_ptr<Device> RunCommand::openDeviceOf(int rankHere, int ranksHere) const {
  if (device_ == "auto" || device_ == "cpu") {
    const int all = threads_ > 0 ? threads_ : CpuDevice().threads();
    return openDevice("cpu", std::max(1, all / ranksHere));
  }
  const int gpus = cudaDeviceCount();
  if (device_ != "cuda" || gpus == 0) return openDevice(device_);
  return openDevice(fmt::format("cuda:{}", rankHere % gpus));
}

void RunCommand::divideAmongGpus() {
  const int there = cudaDeviceCount();
  if (*gpus_ > there && there > 0)
    throw usageError(fmt::format("--gpus {} are more than this machine has", *gpus_),
                     fmt::format("at most {}", there));
  device_ = "cuda";
  ranks_ = gpus_;
}

OnWarning RunCommand::onWarning() const {
  return checkpoint_.empty() ? OnWarning::kEnd : OnWarning::kSave;
}

std::unique_ptr<Scene> RunCommand::loadSilently() const {
  const InterruptibleWork work;
  std::vector<std::string> ignored;
  return loadScene(scene_, program_.registry(), overrides(), ignored, program_.pluginLoader(scene_));
}

RunEnd RunCommand::runOnRanks() const {
  std::vector<std::unique_ptr<Scene>> scenes;
  for (int rank = 0; rank < *ranks_; ++rank)
    scenes.push_back(rank == 0 ? program_.load(scene_, overrides()) : loadSilently());
  RunEnd end = RunEnd::kFailed;
  std::vector<std::unique_ptr<Device>> devices(scenes.size());  // which outlive what ranks send each other
  runOnThreads(*ranks_, [&](Communicator& ranks) {
    const bool speaks = ranks.rank() == 0;
    std::unique_ptr<Device>& device = devices[std::size_t(ranks.rank())];
    device = openDeviceOf(ranks.rank(), ranks.size());
    Log silent;
    const RunEnd own = runScene(std::move(scenes[std::size_t(ranks.rank())]), *device,
                                speaks ? program_.log() : silent, &ranks);
    if (speaks) end = own;
  });
  return end;
}

int RunCommand::runLaunched(LaunchedRanks& launched) const {
  RunEnd end = RunEnd::kFailed;
  const auto work = [&](Communicator& ranks) {
    if (ranks_)
      throw usageError(
          "--ranks is given, and a launcher has started " + std::to_string(ranks.size()) + " ranks already",
          "one of them");
    const bool speaks = ranks.rank() == 0;
    const Interruption interruption(speaks ? onWarning() : OnWarning::kEnd);
    std::vector<OutputLock> locks;
    if (speaks) locks = takeOutputPaths();
    auto scene = speaks ? program_.load(scene_, overrides()) : loadSilently();
    // Where threads are given, they are those of each process.
    const std::unique_ptr<Device> device = openDeviceOf(rankHere(ranks), threads_ > 0 ? 1 : ranks.sizeHere());
    Log silent;
    end = runScene(std::move(scene), *device, speaks ? program_.log() : silent, &ranks);
    if (speaks) printResults();
  };
  launched.run(work, [&](const std::exception_ptr& error, int rank) {
    return tellOfFailedRank(program_.log(), error, rank);
  });
  return exitCodeOf(end);
}

int RunCommand::run() {
  program_.setQuiet(quiet_);
  scene_ = sceneFile(scene_);
  if (gpus_) divideAmongGpus();
  if (resume_ == kNewest && checkpoint_.empty())
    throw usageError("--resume auto is given without --checkpoint, whose file it looks for",
                     "--checkpoint FILE.h5 --resume auto");
  for (auto& [name, launched, source] : program_.registry().createServices<LaunchedRanks>())
    if (launched->present()) return runLaunched(*launched);
  if (isOneOfALaunch())
    throw usageError(
        "a launcher has started several of these processes, and no plugin for MPI is there to join them",
        "mpirun or srun where 'weir info' lists MPI, or one process",
        "--ranks N and --gpus N need no launcher");
  const Interruption interruption(onWarning());  // before the locks, whose files a signal would leave behind
  const std::vector<OutputLock> locks = takeOutputPaths();
  RunEnd end = RunEnd::kFailed;
  if (ranks_) {
    end = runOnRanks();
  } else {
    auto scene = program_.load(scene_, overrides());
    const std::unique_ptr<Device> device = openDevice(device_, threads_);
    end = runScene(std::move(scene), *device, program_.log(), nullptr);
  }
  printResults();
  return exitCodeOf(end);
}

RunEnd RunCommand::runScene(std::unique_ptr<Scene> scene, Device& device, Log& log,
                            Communicator* ranks) const {
  if (deterministic_) device.setDeterministic(true);
  device.profiler().timeKernels(profileKernels_);
  log.info(fmt::format("{} on {}{}", scene->title.empty() ? scene_ : printable(scene->title, 200),
                       device.description(),
                       ranks != nullptr ? fmt::format(", on each of {} ranks", ranks->size()) : ""));
  Simulation simulation(std::move(scene), device, log, program_.registry());

  std::optional<Checkpoint> resumed = readCheckpoint(simulation, ranks);
  std::optional<Checkpoints> checkpoints;
  std::optional<CheckpointsByRanks> byRanks;
  RunOptions options;
  options.lastFrame = frames_;
  if (!checkpoint_.empty()) {
    if (ranks != nullptr)
      options.checkpointsByRanks = &byRanks.emplace(makeCheckpoints(), *ranks);
    else
      options.checkpoints = &checkpoints.emplace(makeCheckpoints());
    const bool isWarned = ranks == nullptr || ranks->rank() == 0;
    if (isWarned) options.saveAndStop = &Interruption::warned();
  }
  if (resumed) options.resume = &resumed->state;
  const std::vector<std::unique_ptr<Observer>> observers = makeObservers(simulation.scene(), ranks);
  std::optional<AgreedRun> agreed;
  const std::unique_ptr<ParcelRoute> route = openRoute(ranks, device, log);  // goes before the simulation
  if (ranks != nullptr) {
    joinRanks(simulation, *ranks, outputs_->anyGathered(simulation.scene(), *ranks));
    agreed.emplace(*ranks, Interruption::asked(), options);
    if (ranks->rank() > 0) {
      std::vector<Observer*> own;
      for (const auto& observer : observers) own.push_back(observer.get());
      const RunEnd end = runSimulation(simulation, own, options);
      if (route) route->end();
      return end;
    }
  }
  const std::int64_t last = lastFrameOf(simulation.clock(), options);
  const RunEnd end = runShown(program_, simulation, observers, options, quiet_,
                              [last](const Simulation& s) { return ProgressState::of(s, last); });
  if (route) route->end();
  log.info(howItEnded(end) + summaryOf(simulation));
  return end;
}

}  // namespace weir::app
