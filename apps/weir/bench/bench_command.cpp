#include "apps/weir/bench/bench_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "apps/weir/bench/copy_bandwidth.h"
#include "apps/weir/bench/machine.h"
#include "apps/weir/standard_streams.h"
#include "framework/base/file_output.h"
#include "framework/base/interruption.h"
#include "framework/base/text.h"

namespace weir::app {

namespace {

constexpr int kMaxThreads = 1024;
constexpr std::int64_t kMinParticles = 64,
                       kMaxParticles = 2'000'000'000;  // what memory holds is asked at the reset
// Without --sizes; more would take hours on a CPU.
constexpr std::int64_t kMaxOnCpu = 600'000;
constexpr std::int64_t kMaxQuick = 64'000;
constexpr double kQuickLateAfter = 0.1;  // s

// Frames of 20 steps of 1 ms, and more time than is needed: a benchmark ends when it has its steps.
constexpr const char* kFrameRate = "world.frame_rate=50";
constexpr double kAfterLate = 100;  // s

template <class T>
std::vector<std::string> namesOf(const std::vector<T>& items) {
  std::vector<std::string> names;
  for (const T& item : items) {
    if constexpr (requires { item.name(); })
      names.push_back(item.name());
    else
      names.push_back(item.name);
  }
  return names;
}

/// Those of `all` whose names were given, in the order of `all`; all if none were. Throws a usage Error.
template <class T>
std::vector<T> choose(const std::vector<T>& all, const std::vector<std::string>& given, const char* option) {
  const std::vector<std::string> names = namesOf(all);
  for (const std::string& name : given)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw usageError(fmt::format("{}: there is no {}", option, inQuotes(name)), joinNames(names),
                       didYouMean(name, names));
  std::vector<T> chosen;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (given.empty() || std::find(given.begin(), given.end(), names[k]) != given.end())
      chosen.push_back(all[k]);
  return chosen;
}

std::string allNames(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

void show(const std::string& text) {
  print(text);
  finishPrinting();  // someone watches
}

std::string aboutCases() {
  std::string text = "Cases:\n";
  for (const BenchCase& c : benchCases()) text += fmt::format("  {:<13} {}\n", c.name, c.about);
  return text + "Usual sizes of the cases dam…: " + allNames(namesOf(blockSizes())) +
         "\nWithout --sizes: all on CUDA, those below 600,000 on the CPU.";
}

}  // namespace

BenchCommand::BenchCommand(CLI::App& app, Program& program)
    : program_(program),
      command_(app.add_subcommand("bench", "Time steps of scenes that come with the program")) {
  command_->add_option("--device", device_, "auto, cpu, cuda or cuda:N")
      ->type_name("D")
      ->capture_default_str();
  command_->add_option("--threads", threads_, "Threads on the CPU; one a core if it is left out")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxThreads));
  command_->add_option("--cases", cases_, "What to run, separated by commas; all if it is left out")
      ->type_name("CASES")
      ->delimiter(',');
  command_
      ->add_option("--sizes", sizes_,
                   "Numbers of particles of the dam break, separated by commas; the nearest block is taken")
      ->type_name("SIZES")
      ->delimiter(',')
      ->check(CLI::Range(kMinParticles, kMaxParticles));
  command_
      ->add_option("--late-after", lateAfter_,
                   "Simulated seconds before developed flow is timed; "
                   "without it as each case says, 1 s for the dam break")
      ->type_name("S")
      ->check(CLI::Range(0.0, 1000.0));
  command_->add_option("--set", set_, "Change a parameter in every case, as for 'weir run'; may be repeated")
      ->type_name("NAME=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  command_->add_option("--json", json_, "Write the results with all that is known of the machine")
      ->type_name("FILE");
  command_->add_flag("--quick", quick_, "A look at whether all works: sizes up to 64,000, late after 0.1 s");
  command_->add_flag(
      "--deterministic", deterministic_,
      "End the run where results could differ from run to run: if neighbour lists overflow on CUDA");
  command_->footer(aboutCases());
}

std::vector<BenchCase> BenchCommand::chosenCases() const {
  return choose(benchCases(), cases_, "--cases");
}

std::vector<BlockSize> BenchCommand::chosenSizes(bool onCpu) const {
  std::vector<BlockSize> sizes;
  for (const std::int64_t particles : sizes_) sizes.push_back(blockOf(particles));
  if (!sizes.empty()) return sizes;
  sizes = blockSizes();
  std::erase_if(sizes, [&](const BlockSize& size) {
    return (quick_ && size.particles() > kMaxQuick) || (onCpu && size.particles() > kMaxOnCpu);
  });
  return sizes;
}

BenchCommand::Job BenchCommand::makeJob(const BenchCase& benchCase, const std::optional<BlockSize>& size) {
  Job job{.benchCase = benchCase, .size = size, .set = benchCase.set};
  job.lateAfter = lateAfter_.value_or(quick_ ? kQuickLateAfter : benchCase.lateAfter);
  const auto set = [&](const std::vector<std::string>& texts) {
    job.set.insert(job.set.end(), texts.begin(), texts.end());
  };
  if (size) set(settingsOf(*size));
  set({kFrameRate, fmt::format("world.duration={:g}", job.lateAfter + kAfterLate)});
  set(set_);
  std::vector<Override> overrides;
  for (const std::string& text : job.set) overrides.push_back(parseOverride(text));
  job.scene = program_.loadText(benchCase.scene, benchSceneText(benchCase.scene), overrides);
  return job;
}

std::vector<BenchCommand::Job> BenchCommand::makeJobs(bool onCpu) {
  const std::vector<BlockSize> sizes = chosenSizes(onCpu);
  std::vector<Job> all;
  for (const BenchCase& benchCase : chosenCases()) {
    if (!benchCase.hasSizes) all.push_back(makeJob(benchCase, {}));
    if (benchCase.hasSizes)
      for (const BlockSize& size : sizes) all.push_back(makeJob(benchCase, size));
  }
  return all;
}

BenchResult BenchCommand::runJob(Job& job, const std::atomic<bool>& stop) {
  BenchResult result{.benchCase = job.benchCase, .size = job.size ? job.size->name() : "", .set = job.set};
  // A device of its own, for the peak of its memory.
  const std::unique_ptr<Device> device = openDevice(device_, threads_);
  if (deterministic_) device->setDeterministic(true);
  Simulation simulation(std::move(job.scene), *device, program_.log(), program_.registry());
  const MeasurementPlan plan{
      .early = job.benchCase.early, .lateAfter = job.lateAfter, .isClosed = job.benchCase.isClosed};
  result.measurement = measure(simulation, plan, stop, [&](const std::string& what) {
    program_.log().info(result.name() + ": " + what);
  });
  return result;
}

Value BenchCommand::asValue(const std::vector<BenchResult>& results, std::string_view end) const {
  Value v = Value::object();
  v["weir_bench"] = 1;  // the version of this form
  v["command"] = commandLine_;
  v["machine"] = machine_;
  v["copy_bytes_per_second"] = bandwidth_;
  v["compression_limit"] = kMaxMeanCompression;
  v["end"] = end;
  Value& list = v["results"] = Value::array();
  for (const BenchResult& result : results) list.push(resultValue(result, bandwidth_));
  return v;
}

void BenchCommand::save(const std::vector<BenchResult>& results, std::string_view end) const {
  if (!json_.empty()) writeFileAtomically(json_, writeJson(asValue(results, end)));
}

int BenchCommand::run(const std::string& commandLine) {
  commandLine_ = commandLine;
  if (!json_.empty()) checkWritable(json_);
  std::vector<Job> jobs;
  {
    const std::unique_ptr<Device> device = openDevice(device_, threads_);
    if (deterministic_) device->setDeterministic(true);
    jobs = makeJobs(device->kind() == DeviceKind::kCpu);
    machine_ = machineValue(*device);
    bandwidth_ = copyBandwidth(*device);
  }
  show(fmt::format("weir {} ({}, {}) on {}\ncopy: {:.4g} GB/s, read and written\n\n{}",
                   machine_.find("version")->asString(), machine_.find("commit")->asString(),
                   machine_.find("build_type")->asString(),
                   machine_.find("device")->find("description")->asString(), 1e-9 * bandwidth_, tableHead()));

  const Interruption interruption;
  std::vector<BenchResult> results;
  std::string_view end = "finished";
  for (Job& job : jobs) {
    results.push_back(runJob(job, interruption.asked()));
    show(tableLines(results.back(), bandwidth_));
    if (results.back().measurement.interrupted) {
      end = "interrupted";
      break;
    }
    save(results, "running");
  }
  save(results, end);
  show("\nms a step in each module:\n");
  for (const BenchResult& result : results) show(moduleLines(result));
  if (!json_.empty()) show(json_ + "\n");
  if (end == "interrupted") return kInterrupted;
  const bool isBad = std::any_of(results.begin(), results.end(), [](const auto& r) { return r.isBad(); });
  return isBad ? kSimulationFailed : kDone;
}

}  // namespace weir::app
